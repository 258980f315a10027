#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mascot::px4 {

// The messages of a PX4 autopilot that we read and write, as CDR lays them out on the wire. World N is NED, body F is
// FRD (vehicle/frames.h); seconds, metres, radians. Source: the message definitions of PX4 1.14 to 1.18.
//
// A *sample* is what DDS carries: four bytes of encapsulation, then the message, then up to three bytes of padding.

using Bytes = std::vector<std::uint8_t>;

/// Releases that differ in what we send or read.
enum class Release { k1_14, k1_15, k1_16_or_1_17, k1_18 };
/// "1.16 or 1.17".
std::string_view Name(Release release);

/// Topics on which vehicles publish their status: each release uses one of them.
inline constexpr std::string_view kStatusTopics[] = {"vehicle_status", "vehicle_status_v1", "vehicle_status_v4"};
/// Likewise of acknowledgements.
inline constexpr std::string_view kAckTopics[] = {"vehicle_command_ack", "vehicle_command_ack_v1"};

/// Values of VehicleStatus.
inline constexpr std::uint8_t kArmed = 2;
inline constexpr std::uint8_t kInHold = 4, kInReturn = 5, kInOffboard = 14, kInLand = 18;

/// What all releases begin VehicleStatus with.
struct Status {
  Release release = Release::k1_15;
  std::uint8_t arming_state = 0;
  std::uint8_t nav_state = 0;

  bool is_armed() const { return arming_state == kArmed; }
  bool is_in_offboard() const { return nav_state == kInOffboard; }
};

struct Odometry {
  enum class PoseFrame : std::uint8_t { kUnknown = 0, kNed = 1, kFrd = 2 };
  enum class VelocityFrame : std::uint8_t { kUnknown = 0, kNed = 1, kFrd = 2, kBody = 3 };
  std::uint64_t timestamp_us = 0;  ///< by the vehicle's clock: good for order alone
  PoseFrame pose_frame = PoseFrame::kUnknown;
  VelocityFrame velocity_frame = VelocityFrame::kUnknown;
  Eigen::Vector3d p_N = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_NF = Eigen::Quaterniond::Identity();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  ///< in N, or with kBody in F
  Eigen::Vector3d w_F = Eigen::Vector3d::Zero();
  std::uint8_t reset_counter = 0;  ///< it changes when the estimator moves its origin
};

struct Ack {
  enum Result : std::uint8_t { kAccepted = 0, kTemporarilyRejected = 1, kDenied = 2 };
  std::uint32_t command = 0;
  std::uint8_t result = 0;
};

struct LandDetected {
  bool landed = false;
};

/// A sample that was not understood, in words: "77 bytes of vehicle_status, not one of the known lengths: 71 (1.14),
/// ...".
struct UnknownSample {
  std::string words;
};

/// What a sample says; nothing and `unknown`, if its length is none that a release has. `topic`: without namespace.
std::optional<Status> ReadStatus(std::string_view topic, std::span<const std::uint8_t> sample, UnknownSample& unknown);
std::optional<Odometry> ReadOdometry(std::span<const std::uint8_t> sample, UnknownSample& unknown);
std::optional<Ack> ReadAck(std::string_view topic, std::span<const std::uint8_t> sample, UnknownSample& unknown);
std::optional<LandDetected> ReadLandDetected(std::span<const std::uint8_t> sample, UnknownSample& unknown);

/// What a set-point controls; the vehicle follows the first true one.
enum class Controlled { kPosition, kVelocity, kAcceleration };

/// A set-point in N. What is NaN is not controlled.
struct Setpoint {
  Eigen::Vector3d p_N, v_N, a_N;
  double yaw_rad;  ///< from north, towards east
};

/// Commands that we give.
enum class Order : std::uint32_t { kLand = 21, kSetMode = 176, kArmOrDisarm = 400 };
inline constexpr float kArm = 1, kDisarm = 0, kEvenInFlight = 21196;
inline constexpr float kCustomMode = 1, kOffboardMode = 6;

struct Command {
  Order order = Order::kSetMode;
  float param1 = 0, param2 = 0;
  std::uint8_t target_system = 1;  ///< the vehicle's MAV_SYS_ID
};

// Samples to send. Time stamps are 0: the vehicle takes the time at which they arrive.
Bytes OffboardControlMode(Release release, Controlled controlled);
Bytes TrajectorySetpoint(const Setpoint& setpoint);
Bytes VehicleCommand(Release release, const Command& command);

}  // namespace mascot::px4
