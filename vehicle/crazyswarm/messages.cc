#include "vehicle/crazyswarm/messages.h"

#include <algorithm>
#include <cmath>

#include "bus/ros_cdr.h"

namespace mascot::crazyswarm {
namespace {

using ros::Cdr;
using ros::Fields;
using ros::ReadAs;
using ros::Write;
using ros::Written;

constexpr std::string_view kFrame = "world";
constexpr std::uint32_t kMostPoses = 1000;

/// geometry_msgs/Pose.
void Take(Fields& fields, Pose& pose) {
  pose.p = fields.Vector();
  pose.q = fields.Quaternion();
}

}  // namespace

std::optional<Pose> ReadPose(std::span<const std::uint8_t> sample) {
  return ReadAs<Pose>(sample, [](Fields& fields) {
    Pose pose;
    fields.Header();
    Take(fields, pose);
    return pose;
  });
}

std::optional<std::vector<Pose>> ReadPoses(std::span<const std::uint8_t> sample) {
  return ReadAs<std::vector<Pose>>(sample, [](Fields& fields) {
    std::vector<Pose> poses;
    fields.Header();
    const auto count = std::min(fields.Next<std::uint32_t>(), kMostPoses);
    for (std::uint32_t k = 0; k < count; ++k) {
      Pose& pose = poses.emplace_back();
      pose.name = fields.Next<std::string>();
      Take(fields, pose);
    }
    return poses;
  });
}

std::optional<Status> ReadStatus(std::span<const std::uint8_t> sample) {
  return ReadAs<Status>(sample, [](Fields& fields) {
    Status status;
    fields.Header();
    status.supervisor = fields.Next<std::uint16_t>();
    status.battery_V = double{fields.Next<float>()};
    return status;
  });
}

Bytes FullState(const Eigen::Vector3d& p, const Eigen::Vector3d& v, const Eigen::Vector3d& a, double yaw_rad) {
  return Written([&](Cdr& cdr) {
    ros::WriteHeader(cdr, kFrame);  // the server looks at no times
    Write(cdr, p);
    cdr << 0.0 << 0.0 << std::sin(yaw_rad / 2) << std::cos(yaw_rad / 2);
    Write(cdr, v);
    Write(cdr, Eigen::Vector3d::Zero());  // angular velocity
    Write(cdr, a);
  });
}

Bytes VelocityWorld(const Eigen::Vector3d& v) {
  return Written([&](Cdr& cdr) {
    ros::WriteHeader(cdr, kFrame);
    Write(cdr, v);
    cdr << 0.0F;  // yaw rate
  });
}

Bytes ArmRequest(bool arm) {
  return Written([&](Cdr& cdr) { cdr << arm; });
}

Bytes EmptyRequest() {
  return Written([](Cdr& cdr) { cdr << std::uint8_t{0}; });  // a message without fields has one byte
}

Bytes SetpointsStopRequest() {
  return Written([](Cdr& cdr) { cdr << std::uint8_t{0} << std::uint32_t{0}; });
}

}  // namespace mascot::crazyswarm
