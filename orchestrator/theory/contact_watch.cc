#include "orchestrator/theory/contact_watch.h"

#include <fmt/format.h>

#include <cstddef>

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

std::string ContactWatch::WhatMayTouch(std::span<const Motion> motions) {
  halves_W_.clear();
  for (std::size_t i = 0; i < motions.size(); ++i) halves_W_.push_back(HalfBox_W(experiment_.agents[i], motions[i]));
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const bool stands = experiment_.agents[i].traits().rolls;
    if (experiment_.physics.ground && !stands && motions[i].p_WB.z() - halves_W_[i].z() < margin_m_ / 4)
      return fmt::format("agent {} may touch the ground", i + 1);
    if (!experiment_.physics.collisions) continue;
    for (std::size_t j = 0; j < i; ++j)
      if (AreNear(experiment_.agents[i], experiment_.agents[j], motions[i].p_WB - motions[j].p_WB,
                  halves_W_[i] + halves_W_[j], margin_m_))
        return fmt::format("agents {} and {} may touch", j + 1, i + 1);
    for (const Obstacle& obstacle : experiment_.physics.obstacles) {
      const Eigen::Vector3d away_W = NearestPoint_W(obstacle, motions[i].p_WB) - motions[i].p_WB;
      if (away_W.norm() < experiment_.agents[i].radius_m() + margin_m_)
        return fmt::format("agent {} may touch an obstacle", i + 1);
    }
  }
  return "";
}

}  // namespace mascot
