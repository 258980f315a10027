#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>

#include "experiment/toml/section.h"

namespace mascot {

/// Proportional and derivative gain of one PD loop.
struct PdGains {
  double kp = 0;
  double kd = 0;
};

/// A quadrotor's body, rotors, default gains and limits. Physics and controller share it, so that both work with the
/// same machine. B is the body frame: x forward, y left, z up.
///
/// Rotors i = 1..4 ("plus" layout, seen from above): 1 front (+x), 2 left (+y), 3 back (-x), 4 right (-y). Rotors 1 and
/// 3 spin so that their drag torque on the body is along +z, 2 and 4 along -z. With b = lift, k = drag, d = arm:
///   T      =  b (w1^2 + w2^2 + w3^2 + w4^2)     thrust along +z_B (N)
///   Gx     =  b d (w2^2 - w4^2)                 roll torque (N m)
///   Gy     =  b d (w3^2 - w1^2)                 pitch torque (N m)
///   Gz     =  k (w1^2 - w2^2 + w3^2 - w4^2)     yaw torque (N m)
/// i.e. [T, Gx, Gy, Gz] = A [w1^2 .. w4^2].
struct Airframe {
  std::string name;
  double mass_kg = 0;
  Eigen::Vector3d inertia_kg_m2 = Eigen::Vector3d::Zero();  ///< diagonal of J in B
  double arm_m = 0;                                         ///< d, centre to rotor
  double lift_n_s2 = 0;                                     ///< b, thrust per squared rotor speed
  double drag_n_m_s2 = 0;                                   ///< k, torque per squared rotor speed
  double linear_drag_kg_per_s = 0;                          ///< B, force per airspeed, isotropic
  double max_thrust_n = 0;                                  ///< thrust of all four rotors together
  double rotor_time_constant_s = 0;                         ///< first-order lag of the rotor speed; 0 = none
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();         ///< collision box, full lengths
  double tilt_limit_rad = 0;                                ///< limit on each of the targets of roll and pitch
  PdGains altitude;                                         ///< m/s^2 per m and per m/s (times the mass)
  PdGains heading;                                          ///< rad/s^2 per rad and per rad/s (times J)
  PdGains attitude;  ///< roll and pitch alike; rad/s^2 per rad and per rad/s (times J)
  PdGains position;  ///< m/s^2 per m and per m/s; tracks, in x and y, the ideal double integrator under the same law

  /// The low-level stack keeps the thrust within these shares of max_thrust_n, so that the rotors can always give some
  /// torque.
  static constexpr double kMinCommandedShare = 0.1;
  static constexpr double kMaxCommandedShare = 0.9;

  /// The low-level stack keeps the rates at which roll and pitch approach their targets below this (rad/s). The rotors
  /// of the built-in airframes can brake it within the tilts that are flown.
  static constexpr double kMaxTurnRate = 3.0;

  double MinCommandedThrust() const { return kMinCommandedShare * max_thrust_n; }  ///< N
  double MaxCommandedThrust() const { return kMaxCommandedShare * max_thrust_n; }  ///< N
  Eigen::Matrix4d Allocation() const;                                              ///< A above
  double MaxRotorSpeed() const;                                                    ///< rad/s, from max_thrust_n
  double HoverRotorSpeed(double gravity_m_per_s2) const;  ///< rad/s; the thrust at this speed is the weight
};

/// The built-in airframes: `mascot`, `mascot_published`, `crazyflie`.
std::span<const Airframe> Airframes();
std::span<const std::string_view> AirframeNames();
/// The keys of a table that describes an airframe.
std::span<const Key> AirframeKeys();
/// Reads `key` of `agents`: the name of a built-in airframe, or a table whose keys are the fields above. Keys that the
/// table leaves out are those of the built-in airframe `base`, by default "mascot". Mistakes are noted in `agents`.
Airframe ReadAirframe(Section& agents, std::string_view key);

}  // namespace mascot
