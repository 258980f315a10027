#pragma once

#include <memory>
#include <span>
#include <vector>

#include "agent/agent.h"
#include "experiment/experiment.h"
#include "orchestrator/team/exchange.h"

namespace mascot {

/// All agents of an experiment in one process. At each tick every agent is asked once, then the tick ends.
class Team {
 public:
  explicit Team(const Experiment& experiment);

  /// Agent::Decide of agent `id`, everybody being where `motions` (by id - 1) say.
  Command Decide(int id, std::int64_t tick, std::span<const Motion> motions);
  /// Agent::Want, likewise.
  Command Want(int id, std::int64_t tick, std::span<const Motion> motions);
  /// What agent `id` said when it was last asked.
  std::span<const double> message(int id) const { return agents_[static_cast<std::size_t>(id - 1)]->message(); }
  void EndTick() { exchange_.EndTick(); }

 private:
  std::vector<std::unique_ptr<Agent>> agents_;
  Exchange exchange_;
};

}  // namespace mascot
