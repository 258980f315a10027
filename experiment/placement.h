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
};

/// Puts every agent into `box`, uniformly but for the separation. With the separation in z alone, heights are found
/// whenever there is room for them; false means that a bounded number of tries found no room.
bool Place(std::vector<AgentConfig>& agents, const Box& box, std::uint64_t seed);

/// The first two agents (by the later id) whose bodies touch at the start, if any.
std::optional<std::pair<int, int>> FirstTouching(const std::vector<AgentConfig>& agents);

}  // namespace mascot
