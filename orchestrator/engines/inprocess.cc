#include "orchestrator/engines/inprocess.h"

#include <chrono>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "experiment/toml/section.h"
#include "orchestrator/engines/flight.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/engines/tick_requests.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

void ActBy(ActionSource& actions, Flight& flight) {
  flight.Sense();
  ForEachAction(actions, flight.tick(), [&](int id, std::span<const double> action) { flight.Act(id, action); });
}

}  // namespace

void RefuseInProcess(const Experiment& experiment, const std::string& who) {
  if (experiment.run.mode == Mode::kRealtime)  // in one process there is no pacing
    throw ConfigError({who + ": expected run.mode = \"lockstep\", got \"realtime\""});
  if (experiment.network.ros_view)  // there is no DDS
    throw ConfigError({who + ": expected network.ros_view = false, got true"});
}

EngineResult RunInProcess(const Experiment& experiment, const std::vector<RowSink*>& sinks,
                          const std::function<bool()>& go_on, RunRequests* requests, Crew& crew,
                          const std::function<void(const std::string& words)>& tell, ActionSource* actions) {
  EngineResult result;
  const auto launched = WallClock::now();
  auto start = launched;
  std::optional<Flight> flight;
  std::optional<TickRequests> asked;
  try {
    flight.emplace(experiment, crew, tell);
    if (requests != nullptr) asked.emplace(experiment, *requests, [&](const Event& event) { flight->Take(event); });
    const auto is_time = [&](std::int64_t tick) {
      if (tick == 0 || !asked) return go_on();
      return asked->Await(tick, flight->new_pace(), go_on) == TickRequests::Next::kTick;
    };
    RowFeed feed(experiment, sinks);
    start = WallClock::now();
    for (std::int64_t tick = 0; is_time(tick); ++tick) {
      if (actions != nullptr) ActBy(*actions, *flight);
      feed.Add(tick, flight->Exchange());
      if (tick == experiment.ticks()) break;
      flight->Step();
    }
  } catch (const std::exception& failure) {
    result.failure = failure.what();
  }
  result.wall_s = std::chrono::duration<double>(WallClock::now() - start).count();
  result.startup_s = std::chrono::duration<double>(start - launched).count();
  if (flight) {
    result.contacts = flight->contacts();
    result.unanswered = flight->unanswered();
  }
  return result;
}

}  // namespace mascot
