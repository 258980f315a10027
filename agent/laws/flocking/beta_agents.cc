#include "agent/laws/flocking/beta_agents.h"

#include <cmath>

#include "agent/laws/flocking/sigma_norm.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

constexpr double kBump = 0.9;  // h of the paper's phi_beta

}  // namespace

// What is seen are the points of some obstacles, in the order of all.
Eigen::Vector3d BetaAgents::Push_W(const Motion& self, std::span<const Eigen::Vector3d> nearest_W) const {
  Eigen::Vector3d a_W = Eigen::Vector3d::Zero();
  auto seen = nearest_W.begin();
  for (const Obstacle& obstacle : obstacles) {
    if (seen == nearest_W.end()) break;
    if (NearestPoint_W(obstacle, self.p_WB) != *seen) continue;
    a_W += PushOfOne_W(self, *seen, VelocityOfNearest_W(obstacle, self.p_WB, self.v_WB));
    ++seen;
  }
  return a_W;
}

Eigen::Vector3d BetaAgents::PushOfOne_W(const Motion& self, const Eigen::Vector3d& q_W,
                                        const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d way_W = q_W - self.p_WB;
  const double l = way_W.norm();
  if (l >= distance_m) return Eigen::Vector3d::Zero();
  const double z = SigmaNorm(l, epsilon), d_beta = SigmaNorm(distance_m, epsilon), off = z - d_beta;
  const double weight = Rho(z / d_beta, kBump), phi = weight * (off / std::sqrt(1 + off * off) - 1);
  return c1 * phi / std::sqrt(1 + epsilon * l * l) * way_W + c2 * weight * (p_W - self.v_WB);
}

std::vector<std::string> BetaAgents::Warnings(const Experiment& experiment) const {
  const double range_m = experiment.sensors.range_m;
  if (obstacles.empty() || !experiment.physics.collisions || range_m >= distance_m) return {};
  if (range_m == 0) return {"sensors.range_m: with 0, the default, the flock does not see the obstacles"};
  return {"sensors.range_m: the flock sees obstacles from " + ShortestFloat(range_m) +
          " m on, nearer than law.obstacle_distance_m = " + ShortestFloat(distance_m)};
}

}  // namespace mascot
