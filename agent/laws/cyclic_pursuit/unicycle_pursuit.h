#pragma once

#include <Eigen/Core>
#include <cmath>

#include "base/motion.h"

namespace mascot {

/// How a unicycle pursues another one; Marshall, Broucke & Francis, "Formations of vehicles in cyclic pursuit" (2004),
/// with a constant speed, and "Pursuit formations of unicycles" (2006), with one that is proportional to the distance:
///   v = speed, or speed_gain r;  w = turn_gain alpha
/// r is the distance and alpha, in (-pi, pi], the angle from the heading to the other, to the left.
struct SteeredPursuit {
  double turn_gain = 0;      ///< 1/s
  double speed_m_per_s = 0;  ///< if speed_gain is 0
  double speed_gain = 0;     ///< 1/s

  /// The velocity that a unicycle must be told to drive so. It drives forward at the part of a velocity along its
  /// heading, and turns such that the point `look_ahead_m` ahead moves with the part across. `way_W`: to the other.
  Eigen::Vector3d Want_W(const Motion& self, const Eigen::Vector3d& way_W, double look_ahead_m) const {
    const Eigen::Vector2d ahead = (self.q_WB * Eigen::Vector3d::UnitX()).head<2>().normalized();
    const Eigen::Vector2d left(-ahead.y(), ahead.x()), way = way_W.head<2>();
    const double alpha_rad = std::atan2(left.dot(way), ahead.dot(way));
    const double v = speed_gain > 0 ? speed_gain * way.norm() : speed_m_per_s;
    const Eigen::Vector2d u = v * ahead + look_ahead_m * turn_gain * alpha_rad * left;
    return {u.x(), u.y(), 0};
  }
};

}  // namespace mascot
