#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace mascot {

/// Motion of one body at one tick. W is the world frame (x east, y north, z up), B the body frame (x forward, y left, z
/// up), whose origin is the body's centre of mass. All components are in W, unless the name ends in _B.
struct Motion {
  Eigen::Vector3d p_WB = Eigen::Vector3d::Zero();            ///< position of the body (m)
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();  ///< unit; takes components in B to components in W
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero();            ///< velocity of the body (m/s)
  Eigen::Vector3d w_WB_B = Eigen::Vector3d::Zero();          ///< angular velocity of B in W, components in B (rad/s)
  Eigen::Vector3d a_WB = Eigen::Vector3d::Zero();            ///< (v(k) - v(k-1)) * control rate (m/s^2); 0 at tick 0
};

/// The inputs of an agent's actuators: for a quadrotor the speeds of its rotors 1..4 (rad/s), otherwise what
/// ModelTraits::actuator says (for a double integrator the force on it in W (N), then 0).
using Actuation = std::array<double, 4>;

/// A quantity that a law can want, and that can drive a model.
enum class Wanted { kAcceleration, kVelocity };

/// Mass of every model without rotors: with 1 kg the force on a double integrator is its acceleration.
inline constexpr double kDoubleIntegratorMass_kg = 1.0;
/// Radius of the sphere that is the body of every model without rotors.
inline constexpr double kBallRadius_m = 0.1;

/// Bits of Command::flags.
enum CommandFlag : std::uint32_t {
  kAccelerationLimited = 1u << 0,  ///< the law wanted more than control.max_acceleration_m_per_s2 along an axis
  kTiltLimited = 1u << 1,          ///< the target of roll or pitch was cut at the tilt limit
  kRotorLimited = 1u << 2,         ///< a rotor speed was cut at what the rotor can do
  kSpeedLimited = 1u << 3,         ///< the law wanted more than control.max_speed_m_per_s along an axis
  kSafetyFiltered = 1u << 4,       ///< law.safety changed what the law wanted, beyond these limits
  kSafetyInfeasible = 1u << 5,     ///< no command within the limits is as safe as law.safety demands
};

/// An agent's answer to one tick. If the law wants a velocity v*, a model driven by acceleration is commanded the
/// acceleration k_v (v* - v), k_v = control.velocity_gain; a model driven by velocity takes v*, and both accelerations
/// are 0.
struct Command {
  Actuation actuator{};
  Eigen::Vector3d a_law_W = Eigen::Vector3d::Zero();      ///< the law's acceleration in W before all limits (m/s^2)
  Eigen::Vector3d a_limited_W = Eigen::Vector3d::Zero();  ///< after law.safety and the limits of acceleration and speed
  std::uint32_t flags = 0;                                ///< CommandFlag bits
  // The wanted velocity in W before and after its limit (m/s), if the law wants a velocity or the model is driven by
  // one; else 0. These two are not on the wire.
  Eigen::Vector3d v_law_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_limited_W = Eigen::Vector3d::Zero();
};

}  // namespace mascot
