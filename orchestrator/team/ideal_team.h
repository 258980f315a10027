#pragma once

#include <Eigen/Core>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/team/team.h"

namespace mascot {

/// The same experiment on ideal bodies: same laws, graph, links, sensors, limits and hold, but bodies that do exactly
/// what they are told. Of models driven by acceleration, double integrators: p+ = p + h v + h^2 u / 2, v+ = v + h u; of
/// models driven by velocity, single integrators: p+ = p + h u. What fidelity is measured against.
class IdealTeam {
 public:
  explicit IdealTeam(const Experiment& experiment);
  /// Position of agent `id` at the current tick, in W (m).
  const Eigen::Vector3d& p_W(int id) const { return motions_[static_cast<std::size_t>(id - 1)].p_WB; }
  /// From this tick to the next.
  void Step();

 private:
  const Experiment& experiment_;
  Team team_;
  std::vector<Motion> motions_;
  std::vector<Command> commands_;
  std::int64_t tick_ = 0;
};

}  // namespace mascot
