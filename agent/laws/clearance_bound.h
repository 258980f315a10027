#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The distance to the nearest obstacle of the ball around the body of `agent` at `p_W` (m), negative if they meet;
/// nullopt: there are no obstacles.
std::optional<double> Clearance_m(const AgentConfig& agent, const Eigen::Vector3d& p_W,
                                  const std::vector<Obstacle>& obstacles);

/// How near agents come to obstacles that push as Repulsion says, while whatever else they want is limited to `speed`,
/// and so is the sum: v* = [f + push n]_s, |f| <= s, with n away from the obstacle. The distance to a convex body is
/// convex, so the clearance c of an agent with velocity v falls at most as fast as along the line:
///   c(t + T) >= c(t) + T n v      and      c'' >= n a
/// Driven by velocity, v = v*: n v >= push(c) - s if that is negative. Held for a tick T, c never falls below the
/// clearance c* of push(c*) = s, if T times the steepness there is at most 1.
/// Driven by acceleration, a = k (v* - v): for the speed of approach y = -n v
///   y' <= -k (w(c) + y),  y <= s,  w = push - s if push < s, else min(push - s, s sqrt(1 - (s / push)^2))
/// The least c is that of the approach with y = s from where the push begins: no other crosses its curve in (c, y),
/// as w grows when c falls. A command held for a tick is at most a tick late, so w is taken at c + s T.
struct ClearanceBound {
  double gain = 0, influence_m = 0, speed = 0;

  /// Why there is no such bound; empty: there is.
  std::string WhyNot(const Experiment& experiment) const;
  /// The least clearance of any agent in an experiment that has obstacles.
  double Least_m(const Experiment& experiment) const;

 private:
  double Least_m(const Experiment& experiment, const AgentConfig& agent) const;
};

}  // namespace mascot
