#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "agent/agent.h"
#include "experiment/experiment.h"

namespace mascot {

/// The same experiment on ideal double integrators: same law, graph, limits and hold, but bodies that do
/// exactly what they are told, p+ = p + h v + h^2 u / 2, v+ = v + h u. What fidelity is measured against.
class IdealTeam {
 public:
  explicit IdealTeam(Experiment& experiment);
  /// Position of agent `id` at the current tick, in W (m).
  const Eigen::Vector3d& p_W(int id) const { return motions_[static_cast<std::size_t>(id - 1)].p_WB; }
  /// From this tick to the next.
  void Step();

 private:
  const Experiment& experiment_;
  std::vector<std::unique_ptr<Agent>> agents_;
  std::vector<Motion> motions_;
  std::vector<Eigen::Vector3d> u_W_;
  std::vector<Heard> heard_;
  std::int64_t tick_ = 0;
};

}  // namespace mascot
