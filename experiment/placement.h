#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The box in which agents get random places, and how far apart these are.
struct Box {
  Eigen::Vector3d min_m;  ///< two opposite corners, in W (m)
  Eigen::Vector3d max_m;
  double separation_m = 0;
  bool in_z_alone = false;  ///< agents are apart in z only, and may meet in x, y
  bool may_touch = false;   ///< bodies do not collide, and may overlap
  bool has_ground = false;  ///< unicycles stand on the ground, whatever the box's heights, and are apart in x, y
  std::vector<Obstacle> obstacles;
};

/// Gives every agent a random place in `box`, uniform except for the separation and the obstacles. The separation is in
/// m. Returns false if a bounded number of tries finds no room; with separation in z alone, heights are always found if
/// there is room for them.
bool Place(std::vector<AgentConfig>& agents, const Box& box, std::uint64_t seed);

/// The first two agents (by the later id) whose bodies touch at the start; nullopt: none.
std::optional<std::pair<int, int>> FirstTouching(const std::vector<AgentConfig>& agents);
/// The first agent whose body (or the upright box around it) is inside an obstacle at the start, and that obstacle's
/// number, from 1; nullopt: none.
std::optional<std::pair<int, int>> FirstInObstacle(const std::vector<AgentConfig>& agents,
                                                   const std::vector<Obstacle>& obstacles);

}  // namespace mascot
