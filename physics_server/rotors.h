#pragma once

#include <Eigen/Core>
#include <vector>

#include "experiment/physics.h"

namespace mascot {

/// Four rotors that follow a command, and the air that slows their body. With the speeds w of the rotors, the body gets
/// [thrust along z_B (N), torque in B (N m)] = allocation [w1^2 .. w4^2], and -drag (v - wind).
struct Rotors {
  Eigen::Matrix4d allocation;          ///< A of Airframe
  double max_speed_rad_per_s = 0;      ///< commands are kept between 0 and this
  double time_constant_s = 0;          ///< first-order lag of the speed; 0: none
  double drag_kg_per_s = 0;            ///< force per airspeed, in all directions alike
  std::vector<RotorFailure> failures;  ///< in order of time; of one rotor, the last that has begun counts
  Eigen::Vector4d speed_rad_per_s;     ///< now

  /// Part of the way to a constant command that a speed goes in dt; exact for a first-order lag.
  double Followed(double dt_s) const;
  /// How many failures have begun at simulated time `t_s`.
  std::size_t FailuresBegun(double t_s) const;
  /// Part of each rotor's thrust and torque that is left at simulated time `t_s`.
  Eigen::Vector4d Remaining(double t_s) const;
};

}  // namespace mascot
