#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

/// The distance to the nearest obstacle of the ball around the body of `agent` at `p_W` (m), negative if they meet;
/// nullopt: there are no obstacles.
std::optional<double> Clearance_m(const AgentConfig& agent, const Eigen::Vector3d& p_W,
                                  const std::vector<Obstacle>& obstacles);

/// A bound of how near agents come to obstacles. An obstacle pushes as Repulsion says, along n, the direction away from
/// it. What an agent wants besides, f, is limited to the speed s = `speed`, and so is the sum: v* = [f + push n]_s, |f|
/// <= s. The distance to a convex body is a convex function, so that the clearance c of an agent with velocity v and
/// acceleration a falls no faster than on a straight way to the body:
///   c(t + T) >= c(t) + T n v      and      c'' >= n a
/// An agent driven by velocity has v = v*, held for a tick T: n v >= push(c) - s wherever that is negative. Its c never
/// falls below the clearance c* of push(c*) = s, if T times the steepness there is at most 1.
/// An agent driven by acceleration has a = k (v* - v). For its speed of approach y = -n v
///   y' <= -k (w(c) + y),  y <= s,  w = push - s if push < s, else min(push - s, s sqrt(1 - (s / push)^2))
/// The approach that comes nearest has y = s where the push begins: w grows as c falls, so that the curve of no other
/// approach in the plane (c, y) crosses its curve. A command held for a tick is at most a tick late, so w is taken at
/// c + s T.
struct ClearanceBound {
  double gain = 0, influence_m = 0, speed = 0;

  /// Why there is no such bound; empty: there is one.
  std::string WhyNot(const Experiment& experiment) const;
  /// The least clearance of any agent in an experiment that has obstacles: not predicted where agents may touch one.
  PredictedFigure Predicted(const Experiment& experiment) const;

 private:
  double Least_m(const Experiment& experiment, const AgentConfig& agent) const;
};

}  // namespace mascot
