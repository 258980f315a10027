#pragma once

#include <Eigen/Core>

namespace mascot {

struct SinesAndCosines {
  Eigen::Vector2d sin, cos;
};

/// Of two angles (rad) at once, with the bits of std::sin and std::cos, in half of their time.
SinesAndCosines SinesAndCosinesOf(const Eigen::Vector2d& angles_rad);

}  // namespace mascot
