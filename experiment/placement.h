#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Where agents get random places.
enum class StartShape {
  kBox,     ///< anywhere in the box
  kPlane,   ///< in the box, at the height of its lower corner
  kCircle,  ///< on a horizontal circle
  kGrid,    ///< on the points of a horizontal square grid, in random order
  kSphere   ///< on the surface of a sphere
};

/// Where agents get random places, and how far apart these are.
struct StartRegion {
  StartShape shape = StartShape::kBox;
  Eigen::Vector3d min_m;  ///< two opposite corners of the box, in W (m); of other shapes, of the box around them
  Eigen::Vector3d max_m;
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();  ///< of the circle, the grid or the sphere, in W
  double radius_m = 0;                                 ///< of the circle or the sphere
  double spacing_m = 0;                                ///< from a point of the grid to the next
  double separation_m = 0;
  bool in_z_alone = false;  ///< agents are apart in z only, and may meet in x, y; in a box alone
  bool may_touch = false;   ///< bodies do not collide, and may overlap
  bool has_ground = false;  ///< unicycles stand on the ground, whatever the region's heights, and are apart in x, y
  std::vector<Obstacle> obstacles;
};

/// Gives every agent a random place in `region`, uniform except for the separation and the obstacles. The separation is
/// in m. Returns false if a bounded number of tries finds no room; with separation in z alone, heights are always found
/// if there is room for them.
bool Place(std::vector<AgentConfig>& agents, const StartRegion& region, std::uint64_t seed);
/// Gives every agent a random velocity, uniform in the ball of this radius (m/s) about zero: in the disc of x and y if
/// `level`, and of agents that roll along their heading.
void DrawVelocities(std::vector<AgentConfig>& agents, double max_speed_m_per_s, bool level, std::uint64_t seed);
/// Gives every agent a random yaw, uniform in [-pi, pi).
void DrawHeadings(std::vector<AgentConfig>& agents, std::uint64_t seed);

/// The first two agents (by the later id) whose bodies touch at the start; nullopt: none.
std::optional<std::pair<int, int>> FirstTouching(const std::vector<AgentConfig>& agents);
/// The first agent whose body (or the upright box around it) is inside an obstacle at the start, and that obstacle's
/// number, from 1; nullopt: none.
std::optional<std::pair<int, int>> FirstInObstacle(const std::vector<AgentConfig>& agents,
                                                   const std::vector<Obstacle>& obstacles);

}  // namespace mascot
