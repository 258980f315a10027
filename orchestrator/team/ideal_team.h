#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/team/team.h"

namespace mascot {

/// Reference for the fidelity of a run: the same laws, graph, links, sensors, limits and hold, but ideal bodies. With
/// control period h and limited command u, a model driven by acceleration becomes a double integrator
/// (p+ = p + h v + h^2 u / 2, v+ = v + h u), a model driven by velocity a single integrator (p+ = p + h u). Where the
/// run goes on without agents that are lost (run.on_agent_loss), an agent whose law fails here keeps its last command.
class IdealTeam {
 public:
  /// `crew`: as for Team.
  explicit IdealTeam(const Experiment& experiment, Crew& crew = Crew::Alone());
  /// Position of agent `id` at the current tick, in W (m).
  const Eigen::Vector3d& p_W(int id) const { return motions_[static_cast<std::size_t>(id - 1)].p_WB; }
  /// Motions of all agents at the current tick, by id - 1.
  std::span<const Motion> motions() const { return motions_; }
  /// What the agents were commanded in the last step, by id - 1.
  std::span<const Command> commands() const { return commands_; }
  /// Call it when events have changed the experiment: from the current tick on, the experiment is `now`.
  void Adopt(const std::shared_ptr<const Experiment>& now) { team_.Adopt(now); }
  /// As Team::Act().
  void Act(int id, std::span<const double> action) { team_.Act(id, action); }
  /// Goes on to the next tick. Throws what a law throws, unless run.on_agent_loss lets the run go on.
  void Step();

 private:
  const Experiment& experiment_;
  Team team_;
  std::vector<Motion> motions_;
  std::vector<Command> commands_;
  std::vector<Team::Failure> failures_;
  std::int64_t tick_ = 0;
};

}  // namespace mascot
