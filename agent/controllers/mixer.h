#pragma once

#include <Eigen/LU>
#include <algorithm>

#include "agent/controller.h"
#include "experiment/airframe.h"

namespace mascot {

/// Turns thrust and torques into rotor speeds within [0, max]: [w1^2 .. w4^2] = A^-1 [T, tau] (A: Airframe).
///
/// Thrust is kept within the airframe's MinCommandedThrust() and MaxCommandedThrust(). If the rotors cannot give all of
/// the torque, roll and pitch are scaled down together, so that their direction stays; yaw, which a quadrotor needs
/// least, gets what is left.
class Mixer {
 public:
  explicit Mixer(const Airframe& airframe)
      : inverse_(airframe.Allocation().inverse()),
        min_thrust_n_(airframe.MinCommandedThrust()),
        max_thrust_n_(airframe.MaxCommandedThrust()),
        max_squared_(airframe.max_thrust_n / (4 * airframe.lift_n_s2)) {}

  /// `thrust_n`: along z_B; `tau_B`: in B (N m). Sets kRotorLimited if anything was cut.
  Controller::Output Mix(double thrust_n, const Eigen::Vector3d& tau_B) const {
    const double kept_n = std::clamp(thrust_n, min_thrust_n_, max_thrust_n_);
    Eigen::Vector4d squared = inverse_.col(0) * kept_n;
    bool limited = kept_n != thrust_n;
    limited |= AddWhatFits(inverse_.col(1) * tau_B.x() + inverse_.col(2) * tau_B.y(), squared);
    limited |= AddWhatFits(inverse_.col(3) * tau_B.z(), squared);
    Controller::Output output;
    Eigen::Vector4d::Map(output.actuator.data()) = squared.cwiseMax(0).cwiseMin(max_squared_).cwiseSqrt();
    if (limited) output.flags |= kRotorLimited;
    return output;
  }

 private:
  // Adds as much of `share` to `squared`, both squared rotor speeds, as keeps every rotor within its range. Returns
  // true if that was not all of it.
  bool AddWhatFits(const Eigen::Vector4d& share, Eigen::Vector4d& squared) const {
    double part = 1;
    for (int i = 0; i < 4; ++i) {
      if (share[i] > 0) part = std::min(part, (max_squared_ - squared[i]) / share[i]);
      if (share[i] < 0) part = std::min(part, squared[i] / -share[i]);
    }
    squared += std::max(part, 0.0) * share;
    return part < 1;
  }

  Eigen::Matrix4d inverse_;  // A^-1
  double min_thrust_n_, max_thrust_n_;
  double max_squared_;  // (rad/s)^2
};

}  // namespace mascot
