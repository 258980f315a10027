#include "vehicle/ardupilot/ardupilot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "vehicle/ardupilot/messages.h"
#include "vehicle/measured_motion.h"
#include "vehicle/topic_problems.h"

namespace mascot {
namespace ardupilot {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

/// How it steers to a position: a velocity in proportion to what is missing, and the fastest that it adds so.
constexpr double kP_per_s = 1.0, kMaxCorrection_m_per_s = 1.0;
/// A take-off by the autopilot itself is over this far below the height that it was asked for.
constexpr double kUp_m = 0.3;
constexpr auto kAskToTakeOffEvery = 1s;

constexpr std::string_view kStatus = "status", kPose = "pose/filtered", kTwist = "twist/filtered", kBattery = "battery";

std::string FailsafeText(std::uint8_t failsafe) {
  switch (failsafe) {
    case Status::kRadio:
      return "radio";
    case Status::kBattery:
      return "battery";
    case Status::kGroundStation:
      return "ground station";
    case Status::kEstimator:
      return "estimator";
    default:
      return fmt::format("number {}", failsafe);
  }
}

/// Why a vehicle with this status cannot be flown; empty: it can.
std::string ProblemOf(const Status& status) {
  if (status.vehicle != Status::kCopter && status.vehicle != Status::kHelicopter)
    return fmt::format("it is no copter (its vehicle type is {})", status.vehicle);
  if (!status.failsafes.empty())
    return fmt::format("one of its failsafes is active: {}", FailsafeText(status.failsafes.front()));
  return "";
}

class Ardupilot final : public Autopilot {
 public:
  Ardupilot(const OutsideDomain::Options& options, const VehicleConfig& vehicle, std::function<void()> on_news)
      : vehicle_(vehicle), on_news_(std::move(on_news)), domain_(options) {
    using Reliability = OutsideDomain::Reliability;
    domain_.Announce(Topic("cmd_vel"), "geometry_msgs::msg::dds_::TwistStamped_", Reliability::kReliable);
    AnnounceService("arm_motors", "ArmMotors", "arming is refused: its pre-arm checks, or its ground station, say why");
    AnnounceService("mode_switch", "ModeSwitch", "the mode is refused");
    AnnounceService("experimental/takeoff", "Takeoff", "taking off is refused");
    Read(kPose, "geometry_msgs::msg::dds_::PoseStamped_", [this](const Bytes& sample) { OnPose(sample); });
    Read(kTwist, "geometry_msgs::msg::dds_::TwistStamped_", [this](const Bytes& sample) { OnTwist(sample); });
    domain_.ReadFromLast(Topic(kStatus), "ardupilot_msgs::msg::dds_::Status_", [this](const Bytes& sample) {
      OnStatus(sample);  // which comes when it changes
      on_news_();
    });
    Read(kBattery, "sensor_msgs::msg::dds_::BatteryState_", [this](const Bytes& sample) { OnBattery(sample); });
  }

  VehicleReport Report() override {
    const std::lock_guard lock(mutex_);
    VehicleReport report = report_;
    report.problem = problems_.First();
    return report;
  }

  void Stream(const VehicleSetpoint& setpoint) override {
    std::optional<double> takeoff_m;
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    {
      const std::lock_guard lock(mutex_);
      if (!report_.motion_L) return;
      const Eigen::Vector3d& p = report_.motion_L->p_WB;
      if (!report_.is_armed) rest_z_ = p.z();
      const double up_z = rest_z_ + vehicle_.takeoff_m;
      is_up_ = report_.is_armed && (is_up_ || p.z() > up_z - std::min(kUp_m, vehicle_.takeoff_m / 2));
      // On the ground it takes no velocities: it has to be asked to take off.
      const bool is_to_climb = setpoint.p_L.z() > rest_z_;
      if (report_.is_armed && !is_up_) {
        if (!is_to_climb || Clock::now() < ask_to_take_off_at_) return;
        ask_to_take_off_at_ = Clock::now() + kAskToTakeOffEvery;
        takeoff_m = up_z;
      } else {
        v = VelocityTo(setpoint, p);
      }
    }
    if (takeoff_m) return domain_.Write(Request("experimental/takeoff"), TakeoffRequest(*takeoff_m));
    domain_.Write(Topic("cmd_vel"), VelocityCommand(v));
  }

  void Ask(VehicleOrder order) override {
    {
      const std::lock_guard lock(mutex_);
      disarms_ = order == VehicleOrder::kStopMotors;
    }
    switch (order) {
      case VehicleOrder::kFollow:
        return domain_.Write(Request("mode_switch"), ModeSwitchRequest(Status::kGuided));
      case VehicleOrder::kArm:
        return domain_.Write(Request("arm_motors"), ArmMotorsRequest(true));
      case VehicleOrder::kLand:
        return domain_.Write(Request("mode_switch"), ModeSwitchRequest(Status::kLand));
      case VehicleOrder::kStopMotors:
        return domain_.Write(Request("arm_motors"), ArmMotorsRequest(false));
    }
  }

 private:
  std::string Topic(std::string_view name) const { return fmt::format("rt/{}/{}", vehicle_.name_space, name); }
  std::string Request(std::string_view service) const {
    return fmt::format("rq/{}/{}Request", vehicle_.name_space, service);
  }
  void AnnounceService(std::string_view service, std::string_view type, std::string refusal) {
    domain_.Announce(Request(service), fmt::format("ardupilot_msgs::srv::dds_::{}_Request_", type),
                     OutsideDomain::Reliability::kReliable);
    domain_.Read(fmt::format("rr/{}/{}Reply", vehicle_.name_space, service),
                 fmt::format("ardupilot_msgs::srv::dds_::{}_Response_", type),
                 [this, refusal = std::move(refusal)](const Bytes& sample) {
                   const auto done = ReadReply(sample);
                   const std::lock_guard lock(mutex_);
                   if (done) report_.refusal = *done ? "" : disarms_ ? "disarming is refused" : refusal;
                 });
  }
  void Read(std::string_view name, const std::string& type, std::function<void(const Bytes&)> on_sample) {
    domain_.Read(Topic(name), type, [this, on_sample = std::move(on_sample)](const Bytes& sample) {
      on_sample(sample);
      on_news_();
    });
  }

  // In threads of Fast DDS.
  void OnPose(const Bytes& sample) {
    const auto pose = ReadPose(sample);
    const std::lock_guard lock(mutex_);
    if (!pose) return Unknown(kPose, sample);
    heard_.p_WB = pose->p;
    heard_.q_WB = pose->q;
    if (!Measure(kPose)) return;
    report_.measured_at = Clock::now();
    if (is_known_) report_.status_at = report_.measured_at;  // a status holds until the next one
    ++report_.motions;
  }
  void OnTwist(const Bytes& sample) {
    const auto twist = ReadTwist(sample);
    const std::lock_guard lock(mutex_);
    if (!twist) return Unknown(kTwist, sample);
    heard_.v_WB = twist->v;
    heard_.w_WB_B = twist->w_B;
    if (report_.motion_L) Measure(kTwist);
  }
  void OnStatus(const Bytes& sample) {
    const auto status = ReadStatus(sample);
    const std::lock_guard lock(mutex_);
    if (!status) return Unknown(kStatus, sample);
    is_known_ = true;
    report_.release = "ArduPilot";
    report_.status_at = Clock::now();
    report_.is_armed = status->is_armed;
    report_.follows = status->mode == Status::kGuided;
    report_.is_landing = status->mode == Status::kLand;
    report_.is_on_ground = !status->is_flying;
    problems_.Set(kStatus, ProblemOf(*status));
  }
  void OnBattery(const Bytes& sample) {
    const auto battery = ReadBattery(sample);
    const std::lock_guard lock(mutex_);
    if (!battery) return Unknown(kBattery, sample);
    problems_.Set(kBattery, "");
    report_.battery = std::isfinite(*battery) ? battery : std::nullopt;
  }

  // With mutex_.
  void Unknown(std::string_view topic, const Bytes& sample) {
    problems_.Set(topic, fmt::format("{} bytes of {} are no such message", sample.size(), topic));
  }
  /// Takes what `heard_` says now, of which `topic` is news; false, if nothing can be flown by it.
  bool Measure(std::string_view topic) {
    const std::string problem = WhyNotMeasured(heard_);
    problems_.Set(topic, problem);
    if (!problem.empty()) return false;
    report_.motion_L = heard_;
    report_.motion_L->q_WB.normalize();
    return true;
  }

  Eigen::Vector3d VelocityTo(const VehicleSetpoint& setpoint, const Eigen::Vector3d& p) const {
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      if (std::isfinite(setpoint.v_L[k])) v[k] += setpoint.v_L[k];
      if (std::isfinite(setpoint.p_L[k]))
        v[k] += std::clamp(kP_per_s * (setpoint.p_L[k] - p[k]), -kMaxCorrection_m_per_s, kMaxCorrection_m_per_s);
    }
    return v;
  }

  const VehicleConfig vehicle_;
  const std::function<void()> on_news_;
  std::mutex mutex_;      // guards what is below
  VehicleReport report_;  // its `problem` is in problems_
  TopicProblems problems_{{kStatus, kPose, kTwist, kBattery}};
  Motion heard_;           // good or not
  bool is_known_ = false;  // its status has been heard
  bool disarms_ = false;   // it was asked to last
  double rest_z_ = 0;      // where it stood before it was armed
  bool is_up_ = false;     // it has taken off since it was armed
  Clock::time_point ask_to_take_off_at_ = {};

  OutsideDomain domain_;  // last, so destroyed first: its readers call the members above
};

}  // namespace
}  // namespace ardupilot

std::unique_ptr<Autopilot> MakeArdupilot(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                         std::function<void()> on_news) {
  return std::make_unique<ardupilot::Ardupilot>(options, vehicle, std::move(on_news));
}

}  // namespace mascot
