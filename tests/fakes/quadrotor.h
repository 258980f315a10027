#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "base/motion.h"

namespace mascot::fakes {

/// The quadrotor of a fake autopilot: it flies accelerations, in a World of ours with flat ground. World east, north,
/// up; body forward, left, up.
class Quadrotor {
 public:
  static constexpr double kPeriod_s = 0.01;
  static constexpr double kOffTheGround_m = 0.06;  ///< higher than that, it has left it

  /// `place_ENU`: of the ground below it (m).
  explicit Quadrotor(const Eigen::Vector3d& place_ENU);
  ~Quadrotor();

  Motion motion() const;
  /// Where its body was when it was switched on.
  Eigen::Vector3d boot_ENU() const;
  /// Flies for kPeriod_s; without an acceleration, its rotors stand still.
  void Step(const std::optional<Eigen::Vector3d>& acceleration_ENU);
  /// Where it stands still on the ground, for how long (s); 0: it does not.
  double resting_s() const { return resting_s_; }
  /// Since it first left the ground (s).
  double flown_s() const { return flown_s_; }
  double height_m() const { return motion().p_WB.z() - boot_ENU().z(); }

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  double resting_s_ = 0, flown_s_ = 0;
};

}  // namespace mascot::fakes
