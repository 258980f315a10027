#include "orchestrator/verbs/viewers.h"

#include "orchestrator/processes/script.h"

namespace mascot {

Answer Viewers::NoControl::Ask(const Wish& /*wish*/) { return {false, "this run cannot be changed while it goes on"}; }

Viewers::Viewers(const std::optional<LiveAddress>& at, const std::string& engine, const Experiment& experiment,
                 const Prediction& prediction, const RunMeter& meter, Console& console) try
    : pace_(experiment.run.mode == Mode::kRealtime ? experiment.run.speed : 0) {
  if (!at) return;
  view_.emplace(experiment, prediction, meter, control_,
                LiveView::Options{.address = at->address,
                                  .port = at->port,
                                  .page = FindShared("page", "orchestrator/live"),
                                  .source = {.engine = engine},
                                  .pace = pace_},
                [&console](const std::string& line) { console.Line(line); });
  console.Line("view           " + view_->url());
} catch (const std::runtime_error& failure) {
  throw ConfigError({std::string("--view: ") + failure.what()});
}

void Viewers::AddTo(std::vector<RowSink*>& sinks) {
  if (view_) sinks.push_back(&*view_);
}

void Viewers::SayHowItEnded(const EngineResult& result) {
  if (!view_) return;
  const auto phase = result.failure.empty() ? RunState::Phase::kDone : RunState::Phase::kFailed;
  RunState state{.phase = phase, .pace = pace_};
  if (result.contacts) state.contacts = static_cast<std::uint64_t>(result.contacts->total());
  view_->SetState(state);
}

}  // namespace mascot
