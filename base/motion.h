#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>

namespace mascot {

/// Motion of one body at one tick. W is the world (x east, y north, z up), B the body (x forward, y left,
/// z up); SI units.
struct Motion {
  Eigen::Vector3d p_WB = Eigen::Vector3d::Zero();            ///< position in W (m)
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();  ///< takes B components to W; w, x, y, z
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero();            ///< velocity in W (m/s)
  Eigen::Vector3d w_WB_B = Eigen::Vector3d::Zero();          ///< angular velocity expressed in B (rad/s)
  Eigen::Vector3d a_WB = Eigen::Vector3d::Zero();            ///< (v(k) - v(k-1)) * control rate, in W; 0 at tick 0
};

/// The inputs of an agent's actuators: rotor speeds 1..4 (rad/s) for a quadrotor, otherwise the model's own
/// (ModelTraits::actuator; double integrator: force in W in newton, then 0).
using Actuation = std::array<double, 4>;

/// A quantity that a law can want, and that can drive a model.
enum class Wanted { kAcceleration, kVelocity };

/// Mass of every model without rotors: with 1 kg the force on a double integrator is its acceleration.
inline constexpr double kDoubleIntegratorMass_kg = 1.0;
/// Radius of the sphere that is the body of every model without rotors.
inline constexpr double kBallRadius_m = 0.1;

/// Bits of Command::flags.
enum CommandFlag : std::uint32_t {
  kAccelerationLimited = 1u << 0,  ///< the law asked for more than control.max_acceleration_m_per_s2
  kTiltLimited = 1u << 1,          ///< roll or pitch target cut at the airframe's tilt limit
  kRotorLimited = 1u << 2,         ///< a rotor speed cut to what the rotor can do
  kSpeedLimited = 1u << 3,         ///< the law asked for more than control.max_speed_m_per_s
  kSafetyFiltered = 1u << 4,       ///< law.safety changed what the law asked for, beyond these limits
  kSafetyInfeasible = 1u << 5,     ///< no command within the limits is as safe as law.safety asks for
};

/// An agent's answer to one tick. A wanted velocity v* is an acceleration k_v (v* - v) for a model driven by
/// acceleration. For a model driven by velocity it is none: both accelerations are then 0.
struct Command {
  Actuation actuator{};
  Eigen::Vector3d a_law_W = Eigen::Vector3d::Zero();  ///< the law's acceleration before all limits (m/s^2)
  Eigen::Vector3d a_limited_W =
      Eigen::Vector3d::Zero();  ///< after law.safety and those of acceleration and speed (m/s^2)
  std::uint32_t flags = 0;      ///< CommandFlag bits
  // Not on the wire: the wanted velocity before and after its limit (m/s), if the law wants one, or the model is driven
  // by it.
  Eigen::Vector3d v_law_W = Eigen::Vector3d::Zero();
  Eigen::Vector3d v_limited_W = Eigen::Vector3d::Zero();
};

}  // namespace mascot
