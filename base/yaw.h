#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace mascot {

/// The yaw of an orientation of B in W (rad); 0 if its x axis is vertical.
inline double YawOf(const Eigen::Quaterniond& q_WB) {
  const Eigen::Vector3d forward_W = q_WB * Eigen::Vector3d::UnitX();
  return forward_W.head<2>().isZero(0) ? 0 : std::atan2(forward_W.y(), forward_W.x());
}

}  // namespace mascot
