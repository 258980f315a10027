#pragma once

#include <memory>
#include <span>
#include <vector>

#include "agent/agent.h"
#include "agent/low_level.h"
#include "experiment/experiment.h"
#include "orchestrator/team/exchange.h"

namespace mascot {

/// All agents of an experiment in one process. At each tick, call Decide, or Want once per agent and then EndTick.
class Team {
 public:
  explicit Team(const Experiment& experiment);

  /// Call it when events have changed the experiment: from the next tick on, the experiment is `now`.
  void Adopt(const std::shared_ptr<const Experiment>& now) {
    for (const auto& agent : agents_) agent->Adopt(now);
  }
  /// The complete commands of all agents, by id - 1. `motions`: their states at this tick. Ends the tick.
  void Decide(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands);
  /// Calls Agent::Want of agent `id`.
  Command Want(int id, std::int64_t tick, std::span<const Motion> motions);
  /// The message that agent `id` sent last.
  std::span<const double> message(int id) const { return agents_[static_cast<std::size_t>(id - 1)]->message(); }
  /// Ends the tick: messages that were sent during it arrive at the next tick.
  void EndTick() { exchange_.EndTick(); }

 private:
  std::vector<std::unique_ptr<Agent>> agents_;
  LowLevel low_level_;
  std::vector<Controller::Input> driven_;  // by id - 1
  Exchange exchange_;
};

}  // namespace mascot
