#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "base/motion.h"

namespace mascot {

/// What a vehicle is to do now, in its local frame L (vehicle/frames.h), with our axes.
struct VehicleSetpoint {
  Eigen::Vector3d p_L, v_L, a_L;  ///< m, m/s, m/s^2; what is NaN is not controlled
  double yaw_L = 0;               ///< rad
};

/// What an autopilot can be asked for. It may refuse; what it does is in its report.
enum class VehicleOrder {
  kFollow,  ///< to follow set-points
  kArm,
  kLand,
  kStopMotors  ///< at once, in the air, too
};

/// What a vehicle has said.
struct VehicleReport {
  using Time = std::chrono::steady_clock::time_point;
  std::string release = {};             ///< of its software: "PX4 1.16 or 1.17"; empty: nothing has been heard yet
  std::optional<Motion> motion_L = {};  ///< the newest; a_WB is 0
  Time measured_at = {};                ///< when motion_L arrived
  std::int64_t motions = 0;             ///< how many have arrived
  Time status_at = {};                  ///< when what follows arrived
  bool is_armed = false;
  bool follows = false;  ///< set-points
  bool is_landing = false;
  bool is_on_ground = true;
  int resets = 0;                      ///< how often its estimator has moved the origin of L
  std::optional<double> battery = {};  ///< share that is left, 0 to 1
  std::string problem = {};            ///< why it cannot be flown, in words: "its heading is unknown"
  std::string refusal = {};            ///< its answer to the newest order that it has refused, in words
};

/// The interface of one kind of vehicle, for one vehicle.
class Autopilot {
 public:
  virtual ~Autopilot() = default;
  /// What has been heard up to now.
  virtual VehicleReport Report() = 0;
  /// Sends a set-point, and the sign of life that the autopilot wants with it.
  virtual void Stream(const VehicleSetpoint& setpoint) = 0;
  virtual void Ask(VehicleOrder order) = 0;
};

}  // namespace mascot
