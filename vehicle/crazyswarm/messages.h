#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mascot::crazyswarm {

// The messages of a Crazyswarm2 server that we read and write, as samples of DDS: four bytes of encapsulation, then
// CDR. The world is that of its motion capture, x, y, z with z up; body x forward, y left, z up; metres, seconds,
// radians. Source: crazyflie_interfaces, motion_capture_tracking_interfaces and standard messages of ROS 2, as of July
// 2026.

using Bytes = std::vector<std::uint8_t>;

struct Pose {
  std::string name = {};  ///< of NamedPoseArray
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
};

struct Status {
  /// Bits of its supervisor.
  enum Supervisor : std::uint16_t {
    kCanBeArmed = 1,
    kIsArmed = 2,
    kArmsItself = 4,
    kCanFly = 8,
    kIsFlying = 16,
    kIsTumbled = 32,
    kIsLocked = 64
  };
  std::uint16_t supervisor = 0;
  double battery_V = 0;

  bool Is(Supervisor bit) const { return (supervisor & bit) != 0; }
};

// What a sample says; nothing if it is too short, or is no such message. A longer one, of a newer release, is read as
// far as it is known.
std::optional<Pose> ReadPose(std::span<const std::uint8_t> sample);
std::optional<std::vector<Pose>> ReadPoses(std::span<const std::uint8_t> sample);
std::optional<Status> ReadStatus(std::span<const std::uint8_t> sample);

/// FullState. It travels to the Crazyflie as int16 of mm, mm/s and mm/s^2 (VehicleConfig::farthest_m).
Bytes FullState(const Eigen::Vector3d& p, const Eigen::Vector3d& v, const Eigen::Vector3d& a, double yaw_rad);
Bytes VelocityWorld(const Eigen::Vector3d& v);
/// The request of the service `arm`.
Bytes ArmRequest(bool arm);
/// The request of the service `emergency`, and of every other without fields.
Bytes EmptyRequest();
/// The request of the service `notify_setpoints_stop`.
Bytes SetpointsStopRequest();

}  // namespace mascot::crazyswarm
