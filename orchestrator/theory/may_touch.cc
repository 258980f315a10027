#include "orchestrator/theory/may_touch.h"

#include <fmt/format.h>

#include <cstddef>
#include <vector>

#include "experiment/obstacles.h"

namespace mascot {
namespace {

/// Half of the lengths of the box around a body, however it is tilted, along the axes of W (m).
Eigen::Vector3d HalfBox_W(const AgentConfig& agent, const Motion& motion) {
  return motion.q_WB.toRotationMatrix().cwiseAbs() * agent.size_m() / 2;
}

/// Whether two bodies `way_W` apart are nearer than `margin_m`: balls, or else the boxes around them, whose lengths are
/// `boxes_W` together.
bool AreNear(const AgentConfig& a, const AgentConfig& b, const Eigen::Vector3d& way_W, const Eigen::Vector3d& boxes_W,
             double margin_m) {
  if (!a.traits().has_airframe && !b.traits().has_airframe)
    return way_W.norm() < a.radius_m() + b.radius_m() + margin_m;
  return (way_W.cwiseAbs().array() < boxes_W.array() + margin_m).all();
}

}  // namespace

std::string WhatMayTouch(const Experiment& experiment, std::span<const Motion> motions, double margin_m) {
  std::vector<Eigen::Vector3d> halves_W;
  for (std::size_t i = 0; i < motions.size(); ++i) halves_W.push_back(HalfBox_W(experiment.agents[i], motions[i]));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const bool stands = experiment.agents[i].traits().rolls;
    if (experiment.physics.ground && !stands && motions[i].p_WB.z() - halves_W[i].z() < margin_m / 4)
      return fmt::format("agent {} may touch the ground", i + 1);
    if (!experiment.physics.collisions) continue;
    for (std::size_t j = 0; j < i; ++j)
      if (AreNear(experiment.agents[i], experiment.agents[j], motions[i].p_WB - motions[j].p_WB,
                  halves_W[i] + halves_W[j], margin_m))
        return fmt::format("agents {} and {} may touch", j + 1, i + 1);
    for (const Obstacle& obstacle : experiment.physics.obstacles) {
      const Eigen::Vector3d away_W = NearestPoint_W(obstacle, motions[i].p_WB) - motions[i].p_WB;
      if (away_W.norm() < experiment.agents[i].radius_m() + margin_m)
        return fmt::format("agent {} may touch an obstacle", i + 1);
    }
  }
  return "";
}

}  // namespace mascot
