#include "orchestrator/inprocess.h"

#include <chrono>
#include <memory>
#include <vector>

#include "agent/agent.h"
#include "agent/hear.h"
#include "idl/wire.h"
#include "physics_server/world.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// Everything that one tick needs, kept from tick to tick so that nothing is allocated in between.
class Team {
 public:
  explicit Team(Experiment& experiment)
      : experiment_(experiment),
        world_(experiment),
        motions_(static_cast<std::size_t>(experiment.size())),
        actuation_(static_cast<std::size_t>(experiment.size())),
        row_(experiment.size()) {
    for (const AgentConfig& config : experiment.agents)
      agents_.push_back(std::make_unique<Agent>(experiment, config.id));
  }

  /// States and commands of the current tick, on "the wire".
  const Row& Exchange() {
    const std::int64_t tick = row_.tick = world_.tick();
    const int rate = experiment_.control.rate_hz;
    ToWire(tick, rate, clock_);
    Serialize(clock_, row_.clock);
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      const int id = agents_[i]->id();
      motions_[i] = world_.State(id);
      ToWire(tick, rate, id, motions_[i], state_);
      Serialize(state_, row_.states[i]);
    }
    for (std::size_t i = 0; i < agents_.size(); ++i) {
      const int id = agents_[i]->id();
      HearAll(experiment_.graph, id, motions_, heard_);
      const Command command = agents_[i]->Decide(tick, motions_[i], heard_);
      actuation_[i] = command.actuator;
      ToWire(tick, rate, id, command, command_);
      Serialize(command_, row_.commands[i]);
    }
    return row_;
  }

  void Step() { world_.Step(actuation_); }
  std::int64_t collisions() const { return world_.collisions(); }

 private:
  Experiment& experiment_;
  World world_;
  std::vector<std::unique_ptr<Agent>> agents_;
  std::vector<Motion> motions_;
  std::vector<Heard> heard_;
  std::vector<Actuation> actuation_;
  Row row_;
  rosgraph_msgs::msg::Clock clock_;
  mascot_msgs::msg::AgentState state_;
  mascot_msgs::msg::AgentCommand command_;
};

}  // namespace

EngineResult RunInProcess(Experiment& experiment, RunWriter& writer,
                          const std::function<bool(std::int64_t tick)>& go_on) {
  EngineResult result;
  result.wire_matches_graph = true;  // there is none: what an agent hears is made from the graph
  const auto launched = WallClock::now();
  Team team(experiment);
  const auto start = WallClock::now();
  try {
    for (std::int64_t tick = 0; go_on(tick); ++tick) {
      writer.Add(team.Exchange());
      if (tick == experiment.ticks()) break;
      team.Step();
    }
  } catch (const std::exception& failure) {
    result.failure = failure.what();
  }
  result.wall_s = std::chrono::duration<double>(WallClock::now() - start).count();
  result.startup_s = std::chrono::duration<double>(start - launched).count();
  result.collisions = team.collisions();
  return result;
}

}  // namespace mascot
