#pragma once

#include <Eigen/Core>

namespace mascot {

struct SinesAndCosines {
  Eigen::Vector2d sin, cos;
};

/// The sines and cosines of two angles (rad), computed at once. They have the bits of std::sin and std::cos.
SinesAndCosines SinesAndCosinesOf(const Eigen::Vector2d& angles_rad);

}  // namespace mascot
