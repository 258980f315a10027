#include "vehicle/px4/px4.h"

#include <fmt/format.h>

#include <mutex>
#include <utility>

#include "vehicle/frames.h"
#include "vehicle/measured_motion.h"
#include "vehicle/px4/messages.h"
#include "vehicle/topic_problems.h"

namespace mascot {
namespace px4 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::string_view kStatus = "vehicle_status", kOdometry = "vehicle_odometry",
                           kLandDetected = "vehicle_land_detected", kAck = "vehicle_command_ack";

std::string TypeName(std::string_view message) { return fmt::format("px4_msgs::msg::dds_::{}_", message); }

/// Why a vehicle with this odometry cannot be flown; empty: it can.
std::string ProblemOf(const Odometry& odometry) {
  if (odometry.pose_frame != Odometry::PoseFrame::kNed)
    return "its heading is unknown (its odometry is not in NED): is there a compass?";
  if (odometry.velocity_frame == Odometry::VelocityFrame::kUnknown) return "the frame of its velocity is unknown";
  return WhyNotMeasured(
      {.p_WB = odometry.p_N, .q_WB = odometry.q_NF, .v_WB = odometry.v, .w_WB_B = odometry.w_F});  // in any frame
}

Motion MotionOf(const Odometry& odometry) {
  const Eigen::Quaterniond q_NF = odometry.q_NF.normalized();
  const bool in_body = odometry.velocity_frame == Odometry::VelocityFrame::kBody;
  return {.p_WB = SwapWorldAxes(odometry.p_N),
          .q_WB = SwapOrientation(q_NF).normalized(),
          .v_WB = SwapWorldAxes(in_body ? q_NF * odometry.v : odometry.v),
          .w_WB_B = SwapBodyAxes(odometry.w_F)};
}

/// `disarms`: it was asked to disarm, not to arm.
std::string RefusalOf(const Ack& ack, bool disarms) {
  if (ack.result == Ack::kAccepted) return "";
  const bool is_temporary = ack.result == Ack::kTemporarilyRejected;
  const std::string how = is_temporary                 ? "is rejected for now"
                          : ack.result == Ack::kDenied ? "is denied"
                                                       : fmt::format("has the result {}", ack.result);
  switch (static_cast<Order>(ack.command)) {
    case Order::kArmOrDisarm:
      if (disarms) return "disarming " + how;
      return "arming " + how +
             ": its ground station says why (without a ground station and a remote control it does not arm, unless "
             "COM_RC_IN_MODE, COM_RCL_EXCEPT and NAV_DLL_ACT allow it)";
    case Order::kSetMode:
      return "offboard mode " + how;
    case Order::kLand:
      return "landing " + how;
  }
  return "";
}

class Px4 final : public Autopilot {
 public:
  Px4(const OutsideDomain::Options& options, const VehicleConfig& vehicle, std::function<void()> on_news)
      : vehicle_(vehicle), on_news_(std::move(on_news)), domain_(options) {
    using Reliability = OutsideDomain::Reliability;
    domain_.Announce(In("offboard_control_mode"), TypeName("OffboardControlMode"), Reliability::kBestEffort);
    domain_.Announce(In("trajectory_setpoint"), TypeName("TrajectorySetpoint"), Reliability::kBestEffort);
    domain_.Announce(In("vehicle_command"), TypeName("VehicleCommand"), Reliability::kReliable);
    for (const std::string_view topic : kStatusTopics)
      Read(topic, "VehicleStatus", [this, topic](const Bytes& sample) { OnStatus(topic, sample); });
    for (const std::string_view topic : kAckTopics)
      Read(topic, "VehicleCommandAck", [this, topic](const Bytes& sample) { OnAck(topic, sample); });
    Read(kOdometry, "VehicleOdometry", [this](const Bytes& sample) { OnOdometry(sample); });
    Read(kLandDetected, "VehicleLandDetected", [this](const Bytes& sample) { OnLandDetected(sample); });
  }

  VehicleReport Report() override {
    const std::lock_guard lock(mutex_);
    VehicleReport report = report_;
    report.problem = problems_.First();
    return report;
  }

  void Stream(const VehicleSetpoint& setpoint) override {
    const Setpoint in_N{.p_N = SwapWorldAxes(setpoint.p_L),
                        .v_N = SwapWorldAxes(setpoint.v_L),
                        .a_N = SwapWorldAxes(setpoint.a_L),
                        .yaw_rad = SwapYaw(setpoint.yaw_L)};
    const auto horizontal = [](const Eigen::Vector3d& vector) { return vector.head<2>().allFinite(); };
    const Controlled controlled = horizontal(in_N.p_N)   ? Controlled::kPosition
                                  : horizontal(in_N.v_N) ? Controlled::kVelocity
                                                         : Controlled::kAcceleration;
    domain_.Write(In("offboard_control_mode"), OffboardControlMode(release(), controlled));
    domain_.Write(In("trajectory_setpoint"), TrajectorySetpoint(in_N));
  }

  void Ask(VehicleOrder order) override {
    {
      const std::lock_guard lock(mutex_);
      disarms_ = order == VehicleOrder::kStopMotors;
    }
    Command command{.target_system = static_cast<std::uint8_t>(vehicle_.system_id)};
    switch (order) {
      case VehicleOrder::kFollow:
        command.order = Order::kSetMode;
        command.param1 = kCustomMode;
        command.param2 = kOffboardMode;
        break;
      case VehicleOrder::kArm:
        command.order = Order::kArmOrDisarm;
        command.param1 = kArm;
        break;
      case VehicleOrder::kLand:
        command.order = Order::kLand;
        break;
      case VehicleOrder::kStopMotors:
        command.order = Order::kArmOrDisarm;
        command.param1 = kDisarm;
        command.param2 = kEvenInFlight;
        break;
    }
    domain_.Write(In("vehicle_command"), VehicleCommand(release(), command));
  }

 private:
  std::string In(std::string_view topic) const { return TopicName("in", topic); }
  std::string TopicName(std::string_view way, std::string_view topic) const {
    return fmt::format("rt/{}{}fmu/{}/{}", vehicle_.name_space, vehicle_.name_space.empty() ? "" : "/", way, topic);
  }
  void Read(std::string_view topic, std::string_view message, std::function<void(const Bytes&)> on_sample) {
    domain_.Read(TopicName("out", topic), TypeName(message),
                 [this, on_sample = std::move(on_sample)](const Bytes& sample) {
                   on_sample(sample);
                   on_news_();
                 });
  }
  Release release() {
    const std::lock_guard lock(mutex_);
    return release_;
  }

  // In threads of Fast DDS.
  void OnStatus(std::string_view topic, const Bytes& sample) {
    UnknownSample unknown;
    const auto status = ReadStatus(topic, sample, unknown);
    const std::lock_guard lock(mutex_);
    report_.status_at = Clock::now();
    problems_.Set(kStatus, unknown.words);
    if (!status) return;
    release_ = status->release;
    report_.release = fmt::format("PX4 {}", Name(status->release));
    report_.is_armed = status->is_armed();
    report_.follows = status->is_in_offboard();
    report_.is_landing = status->nav_state == kInLand;
  }
  void OnOdometry(const Bytes& sample) {
    UnknownSample unknown;
    const auto odometry = ReadOdometry(sample, unknown);
    const std::lock_guard lock(mutex_);
    const std::string problem = odometry ? ProblemOf(*odometry) : unknown.words;
    problems_.Set(kOdometry, problem);
    if (!problem.empty() || IsLate(odometry->timestamp_us)) return;
    if (resets_heard_ && odometry->reset_counter != *resets_heard_) ++report_.resets;
    resets_heard_ = odometry->reset_counter;
    report_.motion_L = MotionOf(*odometry);
    report_.measured_at = Clock::now();
    ++report_.motions;
  }
  void OnLandDetected(const Bytes& sample) {
    UnknownSample unknown;
    const auto land = ReadLandDetected(sample, unknown);
    const std::lock_guard lock(mutex_);
    problems_.Set(kLandDetected, unknown.words);
    if (land) report_.is_on_ground = land->landed;
  }
  void OnAck(std::string_view topic, const Bytes& sample) {
    UnknownSample unknown;
    const auto ack = ReadAck(topic, sample, unknown);
    const std::lock_guard lock(mutex_);
    problems_.Set(kAck, unknown.words);
    if (ack) report_.refusal = RefusalOf(*ack, disarms_);
  }
  /// Whether a newer sample has come before; a clock that goes back by seconds is that of a vehicle that has begun
  /// anew.
  bool IsLate(std::uint64_t timestamp_us) {
    constexpr std::uint64_t kAnew_us = 2'000'000;
    const bool is_late = timestamp_us < newest_us_ && newest_us_ - timestamp_us < kAnew_us;
    if (!is_late) newest_us_ = timestamp_us;
    return is_late;
  }

  const VehicleConfig vehicle_;
  const std::function<void()> on_news_;
  std::mutex mutex_;      // guards what is below
  VehicleReport report_;  // its `problem` is in problems_
  TopicProblems problems_{{kStatus, kOdometry, kLandDetected, kAck}};
  Release release_ = Release::k1_15;
  std::optional<std::uint8_t> resets_heard_;
  std::uint64_t newest_us_ = 0;
  bool disarms_ = false;

  OutsideDomain domain_;  // last, so destroyed first: its readers call the members above
};

}  // namespace
}  // namespace px4

std::unique_ptr<Autopilot> MakePx4(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                   std::function<void()> on_news) {
  return std::make_unique<px4::Px4>(options, vehicle, std::move(on_news));
}

}  // namespace mascot
