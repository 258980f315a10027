#include "orchestrator/live/shown/run_view.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace mascot {

RunView::RunView(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                 RunRequests& requests, const LiveView::Options& options, std::function<void(const std::string&)> log)
    : requests_(requests),
      page_(experiment, prediction, meter, requests, options, std::move(log)),
      events_(page_, requests) {
  page_.SetExperiment(experiment, ShownKeysOf(experiment));
  requests_.CallWhenChanged([this](const RunStatus& status) {
    const auto phase = status.paused ? RunState::Phase::kPaused : RunState::Phase::kRunning;
    page_.SetState({.phase = phase, .pace = status.pace});
  });
}

RunView::~RunView() { requests_.CallWhenChanged(nullptr); }

void RunView::AddTo(std::vector<RowSink*>& sinks) {
  Add(page_, sinks);
  Add(events_, sinks);
}

void RunView::Add(RowSink& sink, std::vector<RowSink*>& sinks) {
  sinks.push_back(
      sinks_.emplace_back(std::make_unique<ViewSink>(sink, [this](const std::string& why) { page_.Fail(why); })).get());
}

void RunView::SayHowItEnded(const EngineResult& result) {
  const auto phase = result.failure.empty() ? RunState::Phase::kDone : RunState::Phase::kFailed;
  RunState state{.phase = phase, .pace = requests_.status().pace};
  if (result.contacts) state.contacts = static_cast<std::uint64_t>(result.contacts->total());
  page_.SetState(state);
}

void RunView::Events::Adopt(const LiveExperiment& live, std::span<const Event> /*events*/) {
  now_ = live.now();
  keys_ = ShownKeysOf(live);
}

void RunView::Events::Add(const FlownRow& row) {
  const auto& events = row.decoded().events;
  if (events.empty()) return;
  const std::vector<int> by_hand = requests_.numbers_by_hand();
  for (const DecodedRow::RowEvent& event : events)
    page_.OnEvent({.number = event.number,
                   .tick = row.tick(),
                   .toml = event.event.Toml(),
                   .by_hand = std::ranges::binary_search(by_hand, event.number)},
                  *now_, keys_);
}

}  // namespace mascot
