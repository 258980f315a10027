#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Where random agents may start, and how far apart.
struct Box {
  Eigen::Vector3d min_m;
  Eigen::Vector3d max_m;
  double separation_m = 0;
  bool in_z_alone = false;  ///< agents that meet in x, y must not collide
  bool may_touch = false;   ///< nobody collides
  bool has_ground = false;  ///< unicycles stand on it and keep their distance in x, y, whatever the box's heights
  std::vector<Obstacle> obstacles;
};

/// Puts every agent into `box`, uniformly but for the separation, clear of obstacles. With the separation in z alone,
/// heights are found whenever there is room for them; false means that a bounded number of tries found no room.
bool Place(std::vector<AgentConfig>& agents, const Box& box, std::uint64_t seed);

/// The first two agents (by the later id) whose bodies touch at the start, if any.
std::optional<std::pair<int, int>> FirstTouching(const std::vector<AgentConfig>& agents);
/// The first agent whose body, or the upright box about it, is inside an obstacle at the start, and that obstacle's
/// number, from 1.
std::optional<std::pair<int, int>> FirstInObstacle(const std::vector<AgentConfig>& agents,
                                                   const std::vector<Obstacle>& obstacles);

}  // namespace mascot
