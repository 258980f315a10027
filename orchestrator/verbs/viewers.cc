#include "orchestrator/verbs/viewers.h"

#include <algorithm>

#include "orchestrator/live/shown_keys.h"
#include "orchestrator/processes/script.h"

namespace mascot {

Viewers::Viewers(const std::optional<LiveAddress>& at, const std::string& engine, const Experiment& experiment,
                 const Prediction& prediction, const RunMeter& meter, Helm& helm, Console& console) try
    : helm_(helm) {
  if (!at) return;
  view_.emplace(experiment, prediction, meter, helm,
                LiveView::Options{.address = at->address,
                                  .port = at->port,
                                  .page = FindShared("page", "orchestrator/live"),
                                  .source = {.engine = engine},
                                  .pace = helm.going().pace},
                [&console](const std::string& line) { console.Line(line); });
  view_->SetExperiment(experiment, ShownKeysOf(experiment));
  events_.emplace(*view_, helm);
  helm.CallWhenChanged([this](const Going& going) {
    const auto phase = going.paused ? RunState::Phase::kPaused : RunState::Phase::kRunning;
    view_->SetState({.phase = phase, .pace = going.pace});
  });
  console.Line("view           " + view_->url());
} catch (const std::runtime_error& failure) {
  throw ConfigError({std::string("--view: ") + failure.what()});
}

Viewers::~Viewers() { helm_.CallWhenChanged(nullptr); }

void Viewers::AddTo(std::vector<RowSink*>& sinks) {
  if (!view_) return;
  sinks.push_back(&*view_);
  sinks.push_back(&*events_);
}

void Viewers::SayHowItEnded(const EngineResult& result) {
  if (!view_) return;
  const auto phase = result.failure.empty() ? RunState::Phase::kDone : RunState::Phase::kFailed;
  RunState state{.phase = phase, .pace = helm_.going().pace};
  if (result.contacts) state.contacts = static_cast<std::uint64_t>(result.contacts->total());
  view_->SetState(state);
}

void Viewers::Events::Add(const FlownRow& row) {
  const auto& events = row.decoded().events;
  if (events.empty()) return;
  const std::vector<int> by_hand = helm_.numbers_by_hand();
  const std::vector<ShownKey> keys = ShownKeysOf(*now_);
  for (const DecodedRow::Happening& event : events)
    view_.OnEvent({.number = event.number,
                   .tick = row.tick(),
                   .toml = event.toml,
                   .by_hand = std::ranges::binary_search(by_hand, event.number)},
                  *now_, keys);
}

}  // namespace mascot
