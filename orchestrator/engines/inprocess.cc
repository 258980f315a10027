#include "orchestrator/engines/inprocess.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "experiment/toml/section.h"
#include "orchestrator/engines/flight.h"
#include "orchestrator/engines/row_feed.h"
#include "physics_server/process/tick_gate.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// Carries out what people ask of the run, and says when it is time for the next tick.
class Steering {
 public:
  Steering(const Experiment& experiment, RunRequests& requests, Flight& flight)
      : requests_(requests), flight_(flight), gate_(experiment.period_s(), requests.status().pace) {}
  ~Steering() { requests_.Close(); }
  Steering(const Steering&) = delete;
  Steering& operator=(const Steering&) = delete;

  /// Waits until it is time for tick `tick`, the next one. Returns false if the run is to end before: by a request, or
  /// because `go_on` says so.
  bool Await(std::int64_t tick, const std::function<bool()>& go_on) {
    if (tick == 0) return go_on();
    requests_.Open();
    if (const auto pace = flight_.new_pace()) SetPace(*pace);
    while (go_on()) {
      if (!CarryOutRequests(tick)) return false;
      const auto now = WallClock::now();
      const auto opens = gate_.Opens(now);
      if (opens && now >= *opens) {
        gate_.OnTick(now);
        return true;
      }
      requests_.WaitUntil(std::min(now + kLookEvery, opens.value_or(now + kLookEvery)));
    }
    return false;
  }

 private:
  static constexpr auto kLookEvery = std::chrono::milliseconds(50);  // whether to go on

  void SetPace(double pace) {
    gate_.SetPace(pace);
    requests_.SetStatus(gate_.paused(), pace);
  }

  /// Returns false if the run is to end.
  bool CarryOutRequests(std::int64_t tick) {
    while (const auto order = requests_.Next()) {
      if (order->kind == Request::Kind::kEvent && static_cast<double>(tick) >= order->number) {
        requests_.CheckAgain();
        continue;
      }
      const bool goes_on = CarryOut(*order);
      requests_.SetStatus(gate_.paused(), gate_.pace());
      requests_.Done(tick);
      if (!goes_on) return false;
    }
    return true;
  }

  bool CarryOut(const RunRequests::Order& order) {
    switch (order.kind) {
      case Request::Kind::kPause:
        gate_.Pause();
        return true;
      case Request::Kind::kResume:
        gate_.Resume();
        return true;
      case Request::Kind::kStep:
        gate_.Step(std::llround(order.number));
        return true;
      case Request::Kind::kPace:
        gate_.SetPace(order.number);
        return true;
      case Request::Kind::kEvent:
        flight_.Take(*order.event);
        return true;
      default:
        return false;
    }
  }

  RunRequests& requests_;
  Flight& flight_;
  TickGate gate_;
};

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
  std::optional<Steering> steering;
  try {
    flight.emplace(experiment, crew, tell);
    if (requests != nullptr) steering.emplace(experiment, *requests, *flight);
    RowFeed feed(experiment, sinks);
    start = WallClock::now();
    for (std::int64_t tick = 0; steering ? steering->Await(tick, go_on) : go_on(); ++tick) {
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
  if (flight) result.contacts = flight->contacts();
  return result;
}

}  // namespace mascot
