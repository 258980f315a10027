#include "vehicle/crazyswarm/crazyswarm.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "vehicle/crazyswarm/messages.h"
#include "vehicle/measured_motion.h"
#include "vehicle/topic_problems.h"

namespace mascot {
namespace crazyswarm {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// Of a cell of lithium polymer, at rest.
constexpr double kEmpty_V = 3.0, kFull_V = 4.2;
/// How fast set-points sink at landing, how far below where the vehicle stood, and how near to that it is down.
constexpr double kSink_m_per_s = 0.3, kBelow_m = 0.05, kDown_m = 0.06;
constexpr auto kDownFor = 500ms, kSetpointsBeginAfter = 1000ms;
constexpr double kSmoothing_s = 0.05;  // time constant of velocities
constexpr std::string_view kStatus = "status", kPoses = "poses", kPose = "pose";
constexpr auto kFreshPoses = 500ms;  // then those of `poses` are preferred to `pose`

double Seconds(Clock::duration time) { return std::chrono::duration<double>(time).count(); }

class Crazyswarm final : public Autopilot {
 public:
  Crazyswarm(const OutsideDomain::Options& options, const VehicleConfig& vehicle, std::function<void()> on_news)
      : vehicle_(vehicle), on_news_(std::move(on_news)), domain_(options) {
    using Reliability = OutsideDomain::Reliability;
    domain_.Announce(In("cmd_full_state"), "crazyflie_interfaces::msg::dds_::FullState_", Reliability::kReliable);
    domain_.Announce(In("cmd_velocity_world"), "crazyflie_interfaces::msg::dds_::VelocityWorld_",
                     Reliability::kReliable);
    domain_.Announce(Request("arm"), "crazyflie_interfaces::srv::dds_::Arm_Request_", Reliability::kReliable);
    domain_.Announce(Request("emergency"), "std_srvs::srv::dds_::Empty_Request_", Reliability::kReliable);
    domain_.Announce(Request("notify_setpoints_stop"), "crazyflie_interfaces::srv::dds_::NotifySetpointsStop_Request_",
                     Reliability::kReliable);
    domain_.Read("rt/poses", "motion_capture_tracking_interfaces::msg::dds_::NamedPoseArray_",
                 [this](const Bytes& sample) { OnPoses(sample); });
    domain_.Read(In(kPose), "geometry_msgs::msg::dds_::PoseStamped_", [this](const Bytes& sample) { OnPose(sample); });
    domain_.Read(In(kStatus), "crazyflie_interfaces::msg::dds_::Status_",
                 [this](const Bytes& sample) { OnStatus(sample); });
  }

  VehicleReport Report() override {
    const std::lock_guard lock(mutex_);
    VehicleReport report = report_;
    report.is_on_ground = IsDown();
    // When set-points have sunk to the ground, its motors are left to stop.
    report.is_armed = report_.is_armed && !(is_landing_ && IsDown());
    report.follows = !report_.release.empty();  // it has no other modes
    report.problem = problems_.First();
    return report;
  }

  void Stream(const VehicleSetpoint& setpoint) override {
    VehicleSetpoint now = setpoint;
    {
      const std::lock_guard lock(mutex_);
      // Set-points begin on the ground. In the air they may have been missing for a while, too.
      const auto time = Clock::now();
      if (!is_flying_ && time - streamed_at_ > kSetpointsBeginAfter && report_.motion_L)
        rest_z_ = report_.motion_L->p_WB.z();
      streamed_at_ = time;
      if (is_landing_) Sink(now);
    }
    const auto known = [](const Eigen::Vector3d& vector) {
      return vector.unaryExpr([](double x) { return std::isnan(x) ? 0 : x; });
    };
    if (!now.p_L.allFinite()) return domain_.Write(In("cmd_velocity_world"), VelocityWorld(known(now.v_L)));
    domain_.Write(In("cmd_full_state"), FullState(now.p_L, known(now.v_L), known(now.a_L), now.yaw_L));
  }

  void Ask(VehicleOrder order) override {
    switch (order) {
      case VehicleOrder::kFollow:
        break;  // it does anyway
      case VehicleOrder::kArm:
        domain_.Write(Request("arm"), ArmRequest(true));
        break;
      case VehicleOrder::kLand: {
        const std::lock_guard lock(mutex_);
        if (!std::exchange(is_landing_, true)) landing_since_ = Clock::now();
        break;
      }
      case VehicleOrder::kStopMotors:
        domain_.Write(Request("emergency"), EmptyRequest());
        break;
    }
  }

 private:
  std::string In(std::string_view topic) const { return fmt::format("rt/{}/{}", vehicle_.name_space, topic); }
  std::string Request(std::string_view service) const {
    return fmt::format("rq/{}/{}Request", vehicle_.name_space, service);
  }

  // In threads of Fast DDS.
  void OnPoses(const Bytes& sample) {
    const auto poses = ReadPoses(sample);
    if (!poses) return Unknown(kPoses, sample);
    const auto own = std::ranges::find(*poses, vehicle_.name_space, &Pose::name);
    if (own == poses->end()) return;
    {
      const std::lock_guard lock(mutex_);
      poses_at_ = Clock::now();
      Measure(kPoses, *own);
    }
    on_news_();
  }
  void OnPose(const Bytes& sample) {
    const auto pose = ReadPose(sample);
    if (!pose) return Unknown(kPose, sample);
    {
      const std::lock_guard lock(mutex_);
      if (Clock::now() - poses_at_ < kFreshPoses) return;
      Measure(kPose, *pose);
    }
    on_news_();
  }
  void OnStatus(const Bytes& sample) {
    const auto status = ReadStatus(sample);
    if (!status) return Unknown(kStatus, sample);
    {
      const std::lock_guard lock(mutex_);
      report_.release = "Crazyswarm2";
      report_.status_at = Clock::now();
      report_.is_armed = status->Is(Status::kIsArmed) && status->Is(Status::kCanFly);
      is_flying_ = status->Is(Status::kIsFlying);
      report_.battery.reset();
      if (std::isfinite(status->battery_V))
        report_.battery = std::clamp((status->battery_V - kEmpty_V) / (kFull_V - kEmpty_V), 0.0, 1.0);
      problems_.Set(kStatus, status->Is(Status::kIsTumbled)  ? "it has tumbled"
                             : status->Is(Status::kIsLocked) ? "it is locked: switch it off and on again"
                                                             : "");
      report_.refusal =
          status->Is(Status::kCanBeArmed) || status->Is(Status::kIsArmed) ? "" : "its supervisor does not let it arm";
    }
    on_news_();
  }
  void Unknown(std::string_view topic, const Bytes& sample) {
    const std::lock_guard lock(mutex_);
    problems_.Set(topic, fmt::format("{} bytes of {} are no such message", sample.size(), topic));
  }

  // With mutex_.
  void Measure(std::string_view topic, const Pose& pose) {
    const std::string problem = WhyNotMeasured({.p_WB = pose.p, .q_WB = pose.q});
    problems_.Set(topic, problem);
    if (!problem.empty()) return;
    const auto now = Clock::now();
    Motion motion{.p_WB = pose.p, .q_WB = pose.q.normalized()};
    if (report_.motion_L) {
      const double dt_s = std::max(Seconds(now - report_.measured_at), 1e-4);
      const Eigen::Vector3d newest = (motion.p_WB - report_.motion_L->p_WB) / dt_s;
      const double share = 1 - std::exp(-dt_s / kSmoothing_s);
      motion.v_WB = report_.motion_L->v_WB + share * (newest - report_.motion_L->v_WB);
      const Eigen::AngleAxisd turned(report_.motion_L->q_WB.conjugate() * motion.q_WB);
      motion.w_WB_B = turned.axis() * std::remainder(turned.angle(), 2 * M_PI) / dt_s;
    }
    report_.motion_L = motion;
    report_.measured_at = now;
    ++report_.motions;
    const bool is_low = motion.p_WB.z() < rest_z_ + kDown_m;
    if (!is_low) low_since_.reset();
    if (is_low && !low_since_) low_since_ = now;
  }
  bool IsDown() const { return low_since_ && Clock::now() - *low_since_ > kDownFor; }
  void Sink(VehicleSetpoint& setpoint) {
    if (!report_.motion_L) return;
    if (!sinks_from_) sinks_from_ = report_.motion_L->p_WB;
    setpoint.p_L = *sinks_from_;
    setpoint.p_L.z() =
        std::max(rest_z_ - kBelow_m, sinks_from_->z() - kSink_m_per_s * Seconds(Clock::now() - landing_since_));
    setpoint.v_L = {0, 0, -kSink_m_per_s};
    setpoint.a_L.setZero();
  }

  const VehicleConfig vehicle_;
  const std::function<void()> on_news_;
  std::mutex mutex_;      // guards what is below
  VehicleReport report_;  // its `problem` is in problems_
  TopicProblems problems_{{kStatus, kPoses, kPose}};
  Clock::time_point poses_at_ = {}, landing_since_ = {};
  double rest_z_ = 0;       // where it stood when set-points began
  bool is_flying_ = false;  // as it says, once a second
  Clock::time_point streamed_at_ = {};
  std::optional<Clock::time_point> low_since_;
  bool is_landing_ = false;
  std::optional<Eigen::Vector3d> sinks_from_;

  OutsideDomain domain_;  // last, so destroyed first: its readers call the members above
};

}  // namespace
}  // namespace crazyswarm

std::unique_ptr<Autopilot> MakeCrazyswarm(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                          std::function<void()> on_news) {
  return std::make_unique<crazyswarm::Crazyswarm>(options, vehicle, std::move(on_news));
}

}  // namespace mascot
