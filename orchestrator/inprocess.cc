#include "orchestrator/inprocess.h"

#include <chrono>
#include <vector>

#include "idl/wire.h"
#include "orchestrator/team.h"
#include "physics_server/world.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// Everything that one tick needs, kept from tick to tick so that nothing is allocated in between.
class Flight {
 public:
  explicit Flight(Experiment& experiment)
      : experiment_(experiment),
        world_(experiment),
        team_(experiment),
        motions_(static_cast<std::size_t>(experiment.size())),
        actuation_(static_cast<std::size_t>(experiment.size())),
        row_(experiment.size()) {}

  /// States and commands of the current tick, on "the wire".
  const Row& Exchange() {
    const std::int64_t tick = row_.tick = world_.tick();
    const int rate = experiment_.control.rate_hz;
    ToWire(tick, rate, clock_);
    Serialize(clock_, row_.clock);
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const int id = static_cast<int>(i) + 1;
      motions_[i] = world_.State(id);
      ToWire(tick, rate, id, motions_[i], state_);
      Serialize(state_, row_.states[i]);
    }
    for (std::size_t i = 0; i < motions_.size(); ++i) {
      const int id = static_cast<int>(i) + 1;
      const Command command = team_.Decide(id, tick, motions_);
      actuation_[i] = command.actuator;
      ToWire(tick, rate, id, command, command_);
      Serialize(command_, row_.commands[i]);
      if (!experiment_.agents[i].sends_messages) continue;
      ToWire(tick, rate, id, team_.message(id), message_);
      Serialize(message_, row_.messages[i]);
    }
    team_.EndTick();
    return row_;
  }

  void Step() { world_.Step(actuation_); }
  Contacts contacts() const { return world_.contacts(); }

 private:
  Experiment& experiment_;
  World world_;
  Team team_;
  std::vector<Motion> motions_;
  std::vector<Actuation> actuation_;
  Row row_;
  rosgraph_msgs::msg::Clock clock_;
  mascot_msgs::msg::AgentState state_;
  mascot_msgs::msg::AgentCommand command_;
  mascot_msgs::msg::AgentMessage message_;
};

}  // namespace

EngineResult RunInProcess(Experiment& experiment, RunWriter& writer,
                          const std::function<bool(std::int64_t tick)>& go_on) {
  EngineResult result;
  result.wire_matches_graph = true;  // there is none: what an agent hears is made from the graph
  const auto launched = WallClock::now();
  Flight flight(experiment);
  const auto start = WallClock::now();
  try {
    for (std::int64_t tick = 0; go_on(tick); ++tick) {
      writer.Add(flight.Exchange());
      if (tick == experiment.ticks()) break;
      flight.Step();
    }
  } catch (const std::exception& failure) {
    result.failure = failure.what();
  }
  result.wall_s = std::chrono::duration<double>(WallClock::now() - start).count();
  result.startup_s = std::chrono::duration<double>(start - launched).count();
  result.contacts = flight.contacts();
  return result;
}

}  // namespace mascot
