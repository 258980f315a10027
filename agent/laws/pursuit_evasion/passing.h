#pragma once

#include <algorithm>
#include <span>

#include "experiment/experiment.h"

namespace mascot {

/// Whether the agent `flies`, which moves `way_m` from its start straight away from the start of `chaser`, comes within
/// `radius_m` of the start of any other agent, along the axes of its law. If rounding decides, it counts as within.
inline bool FliesPast(const Experiment& experiment, const AgentConfig& flies, const AgentConfig& chaser, double way_m,
                      double radius_m) {
  const auto along = [&](const Eigen::Vector3d& v_W) { return Along(flies.law.axes, v_W); };
  const Eigen::Vector3d away_W = along(flies.p_W - chaser.p_W).normalized();
  return std::ranges::any_of(experiment.agents, [&](const AgentConfig& other) {
    const Eigen::Vector3d to_W = along(other.p_W - flies.p_W);
    const double along_m = std::clamp(to_W.dot(away_W), 0.0, way_m);
    return other.id != flies.id && (to_W - along_m * away_W).norm() <= radius_m * (1 + 1e-9);
  });
}

/// Whether the agent `flies` hears only one other agent, which is the only one of `chasers`, and flies past no other:
/// its way is then a straight line.
inline bool IsDrivenAway(const Experiment& experiment, const AgentConfig& flies,
                         std::span<const AgentConfig* const> chasers, double way_m, double radius_m) {
  const std::span<const Graph::Neighbour> heard = experiment.graph.HeardBy(flies.id);
  return chasers.size() == 1 && heard.size() == 1 && heard[0].id == chasers[0]->id &&
         !FliesPast(experiment, flies, *chasers[0], way_m, radius_m);
}

}  // namespace mascot
