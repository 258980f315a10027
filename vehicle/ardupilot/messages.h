#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mascot::ardupilot {

// The messages of ArduPilot's interface on DDS that we read and write, as samples of DDS: four bytes of encapsulation,
// then CDR. Its local frame is east, north, up from its home; body x forward, y left, z up; metres, seconds, radians.
// Source: libraries/AP_DDS and ardupilot_msgs of its repository (2026), and standard messages of ROS 2.

using Bytes = std::vector<std::uint8_t>;

struct Pose {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
};

struct Twist {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();    ///< east, north, up
  Eigen::Vector3d w_B = Eigen::Vector3d::Zero();  ///< in the body
};

struct Status {
  enum Vehicle : std::uint8_t { kCopter = 2, kHelicopter = 13 };
  enum Mode : std::uint8_t { kGuided = 4, kLand = 9 };  // of copters
  enum Failsafe : std::uint8_t { kRadio = 21, kBattery = 22, kGroundStation = 23, kEstimator = 24 };
  std::uint8_t vehicle = 0;
  bool is_armed = false;
  std::uint8_t mode = 0;
  bool is_flying = false;
  std::vector<std::uint8_t> failsafes = {};  ///< those that are active
};

// What a sample says; nothing if it is too short, or is no such message. A longer one, of a newer release, is read as
// far as it is known.
std::optional<Pose> ReadPose(std::span<const std::uint8_t> sample);
std::optional<Twist> ReadTwist(std::span<const std::uint8_t> sample);
std::optional<Status> ReadStatus(std::span<const std::uint8_t> sample);
/// Reads sensor_msgs/BatteryState: the share of the battery that is left, 0 to 1; NaN: unknown.
std::optional<double> ReadBattery(std::span<const std::uint8_t> sample);
/// Reads a reply of `arm_motors`, `mode_switch` or `takeoff`: whether it was done.
std::optional<bool> ReadReply(std::span<const std::uint8_t> sample);

/// TwistStamped in the local frame, without a turn.
Bytes VelocityCommand(const Eigen::Vector3d& v);
Bytes ArmMotorsRequest(bool arm);
Bytes ModeSwitchRequest(Status::Mode mode);
/// `height_m`: above its home.
Bytes TakeoffRequest(double height_m);

}  // namespace mascot::ardupilot
