#include "vehicle/ardupilot/messages.h"

#include <algorithm>

#include "bus/ros_cdr.h"

namespace mascot::ardupilot {
namespace {

using ros::Cdr;
using ros::Fields;
using ros::ReadAs;
using ros::Written;

constexpr std::string_view kFrame = "map";
constexpr std::uint32_t kMostFailsafes = 100;

}  // namespace

std::optional<Pose> ReadPose(std::span<const std::uint8_t> sample) {
  return ReadAs<Pose>(sample, [](Fields& fields) {
    fields.Header();
    const Eigen::Vector3d p = fields.Vector();
    return Pose{.p = p, .q = fields.Quaternion()};
  });
}

std::optional<Twist> ReadTwist(std::span<const std::uint8_t> sample) {
  return ReadAs<Twist>(sample, [](Fields& fields) {
    fields.Header();
    const Eigen::Vector3d v = fields.Vector();
    return Twist{.v = v, .w_B = fields.Vector()};
  });
}

std::optional<Status> ReadStatus(std::span<const std::uint8_t> sample) {
  return ReadAs<Status>(sample, [](Fields& fields) {
    Status status;
    fields.Header();
    status.vehicle = fields.Next<std::uint8_t>();
    status.is_armed = fields.Next<bool>();
    status.mode = fields.Next<std::uint8_t>();
    status.is_flying = fields.Next<bool>();
    fields.Next<bool>();  // whether others may command it; it refuses if not
    const auto count = std::min(fields.Next<std::uint32_t>(), kMostFailsafes);
    for (std::uint32_t k = 0; k < count; ++k) status.failsafes.push_back(fields.Next<std::uint8_t>());
    return status;
  });
}

std::optional<double> ReadBattery(std::span<const std::uint8_t> sample) {
  return ReadAs<double>(sample, [](Fields& fields) {
    fields.Header();
    for (int k = 0; k < 6; ++k) fields.Next<float>();  // voltage, temperature, current and three amounts of charge
    return double{fields.Next<float>()};
  });
}

std::optional<bool> ReadReply(std::span<const std::uint8_t> sample) {
  return ReadAs<bool>(sample, [](Fields& fields) { return fields.Next<bool>(); });
}

Bytes VelocityCommand(const Eigen::Vector3d& v) {
  return Written([&](Cdr& cdr) {
    ros::WriteHeader(cdr, kFrame);
    ros::Write(cdr, v);
    ros::Write(cdr, Eigen::Vector3d::Zero());
  });
}

Bytes ArmMotorsRequest(bool arm) {
  return Written([&](Cdr& cdr) { cdr << arm; });
}

Bytes ModeSwitchRequest(Status::Mode mode) {
  return Written([&](Cdr& cdr) { cdr << static_cast<std::uint8_t>(mode); });
}

Bytes TakeoffRequest(double height_m) {
  return Written([&](Cdr& cdr) { cdr << static_cast<float>(height_m); });
}

}  // namespace mascot::ardupilot
