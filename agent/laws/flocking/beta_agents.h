#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"
#include "experiment/obstacles.h"

namespace mascot {

/// What obstacles do to an agent in Olfati-Saber's flocking (2006), algorithm 3. On each obstacle that is near sits a
/// beta agent, at the point q of the obstacle that is nearest to the agent. As the agent flies past, the beta agent
/// flies along the surface, with the velocity p of that point. That is P v on a wall, with P = I - n n' and n its
/// normal, and R / |x - y| P v on a sphere about y of radius R (VelocityOfNearest_W in experiment/obstacles.h).
struct BetaAgents {
  double distance_m = 1;  ///< a beta agent farther away than this does nothing
  double epsilon = 0.1;   ///< parameter of the smooth norm (1/m^2)
  double c1 = 0;          ///< 1/s^2
  double c2 = 0;          ///< 1/s
  std::vector<Obstacle> obstacles;

  /// The acceleration of agent `self` by the beta agents that it sees: `nearest_W` as for Law::See().
  Eigen::Vector3d Push_W(const Motion& self, std::span<const Eigen::Vector3d> nearest_W) const;
  /// The acceleration by one of them, at `q_W` with the velocity `p_W`:
  ///   c1 phi_beta(|q - x|_sigma) n + c2 rho_h(|q - x|_sigma / d_beta) (p - v),  n = (q - x) / sqrt(1 + epsilon |q -
  ///   x|^2) phi_beta(z) = rho_h(z / d_beta) (sigma_1(z - d_beta) - 1),  sigma_1(z) = z / sqrt(1 + z^2),  h = 0.9
  Eigen::Vector3d PushOfOne_W(const Motion& self, const Eigen::Vector3d& q_W, const Eigen::Vector3d& p_W) const;
  /// Whether the agents can see an obstacle that pushes them.
  bool MayPush(const Experiment& experiment) const { return experiment.sensors.range_m > 0 && !obstacles.empty(); }
  /// Warnings about how the agents see obstacles.
  std::vector<std::string> Warnings(const Experiment& experiment) const;
};

}  // namespace mascot
