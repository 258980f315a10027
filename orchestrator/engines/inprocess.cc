#include "orchestrator/engines/inprocess.h"

#include <chrono>
#include <optional>

#include "agent/laws.h"
#include "experiment/live_experiment.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/team/team.h"
#include "physics_server/world.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// World, agents and buffers of a run; the buffers are reused, so that ticks do not allocate.
class Flight {
 public:
  explicit Flight(const Experiment& experiment)
      : experiment_(experiment),
        world_(experiment),
        team_(experiment),
        live_(experiment, &LawTable(), /*checked=*/true),
        actuation_(static_cast<std::size_t>(experiment.size())),
        row_(experiment.size()) {}

  /// States of the current tick, and the commands and messages that answer them. Valid until the next call.
  const DecodedRow& Exchange() {
    const std::int64_t tick = world_.tick();
    TakeEvents(tick);
    for (const AgentConfig& agent : experiment_.agents)
      row_.motions[static_cast<std::size_t>(agent.id - 1)] = world_.State(agent.id);
    for (const AgentConfig& agent : experiment_.agents) {
      const auto i = static_cast<std::size_t>(agent.id - 1);
      row_.commands[i] = team_.Decide(agent.id, tick, row_.motions);
      row_.commands[i].v_law_W.setZero();  // as over DDS, where velocities are not sent
      row_.commands[i].v_limited_W.setZero();
      actuation_[i] = row_.commands[i].actuator;
      const std::span<const double> message = team_.message(agent.id);
      row_.messages[i].assign(message.begin(), message.end());
    }
    team_.EndTick();
    return row_;
  }

  void Step() { world_.Step(actuation_); }
  Contacts contacts() const { return world_.contacts(); }

 private:
  void TakeEvents(std::int64_t tick) {
    row_.events.clear();
    while (next_event_ < experiment_.events.size() && experiment_.events[next_event_].tick == tick) {
      const Event& event = experiment_.events[next_event_++];
      live_.Take(event);
      row_.events.push_back({++row_.events_so_far, event.Toml()});
    }
    if (row_.events.empty()) return;
    world_.Adopt(*live_.now());
    team_.Adopt(live_.now());
  }

  const Experiment& experiment_;
  World world_;
  Team team_;
  LiveExperiment live_;
  std::size_t next_event_ = 0;  // in experiment_.events
  std::vector<Actuation> actuation_;
  DecodedRow row_;
};

}  // namespace

EngineResult RunInProcess(const Experiment& experiment, const std::vector<RowSink*>& sinks,
                          const std::function<bool()>& go_on) {
  EngineResult result;
  result.wire_matches_graph = true;  // no wire here: each agent gets only the samples that the graph allows
  const auto launched = WallClock::now();
  auto start = launched;
  std::optional<Flight> flight;
  try {
    flight.emplace(experiment);
    RowFeed feed(experiment, sinks);
    start = WallClock::now();
    for (std::int64_t tick = 0; go_on(); ++tick) {
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
