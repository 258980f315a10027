#include "vehicle/pilot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "vehicle/place_text.h"

namespace mascot {
namespace {

constexpr double kFree = std::numeric_limits<double>::quiet_NaN();
const Eigen::Vector3d kUncontrolled = Eigen::Vector3d::Constant(kFree);

double Seconds(std::chrono::steady_clock::duration time) { return std::chrono::duration<double>(time).count(); }

/// A motion along straight lines from corner to corner at one speed.
struct OnPath {
  Eigen::Vector3d p, v;
  bool is_over;
};
OnPath Along(std::initializer_list<Eigen::Vector3d> corners, double speed_m_per_s, double t_s) {
  const Eigen::Vector3d* from = corners.begin();
  for (const Eigen::Vector3d* to = from + 1; to != corners.end(); from = to++) {
    const double length = (*to - *from).norm(), duration_s = length / speed_m_per_s;
    if (t_s < duration_s) {
      const Eigen::Vector3d v = (*to - *from) / duration_s;
      return {*from + v * t_s, v, false};
    }
    t_s -= duration_s;
  }
  return {*from, Eigen::Vector3d::Zero(), true};
}

/// Whether a place is in a fence, but for its bottom: a vehicle on the ground may be below that.
bool IsBelowTheTop(const Eigen::AlignedBox3d& fence, const Eigen::Vector3d& p_W) {
  return fence.contains(Eigen::Vector3d(p_W.x(), p_W.y(), std::max(p_W.z(), fence.min().z())));
}

/// How far a place is from the origin of a vehicle's frame, along the axis where it is farthest (m).
double Farthest(const LocalFrame& frame, const Eigen::Vector3d& p_W) {
  return frame.FromWorld({.p_WB = p_W}).p_WB.cwiseAbs().maxCoeff();
}

}  // namespace

PilotRules PilotRulesOf(const Experiment& experiment, int agent) {
  const AgentConfig& config = experiment.agent(agent);
  const VehicleConfig& vehicle = config.vehicle.value();
  return {.setpoint = vehicle.setpoint,
          .start_W = config.p_W,
          .start_yaw = config.heading_rad,
          .holds_height = config.law.axes == Axes::kXy,
          .takeoff_m = vehicle.takeoff_m,
          .fence = vehicle.fence_W,
          .max_error_m = vehicle.max_error_m,
          .rate_hz = static_cast<double>(experiment.control.rate_hz),
          .frame = {.p_WL = vehicle.origin_W, .yaw_WL = vehicle.yaw_rad},
          .arms_itself = vehicle.arms_itself,
          .farthest_m = vehicle.farthest_m};
}

std::vector<std::string> WhyNotToStart(const PilotRules& rules, const VehicleReport& report,
                                       const Eigen::Vector3d& p_W) {
  std::vector<std::string> reasons;
  if (!report.problem.empty()) reasons.push_back(report.problem);
  if (report.is_armed && !rules.arms_itself) reasons.push_back("it is armed already");
  if (report.battery && *report.battery < Pilot::kBatteryToStart)
    reasons.push_back(fmt::format("its battery is at {:.0f} %, and {:.0f} % are wanted", 100 * *report.battery,
                                  100 * Pilot::kBatteryToStart));
  const double from_start_m = (p_W - rules.start_W).head<2>().norm();
  if (from_start_m > Pilot::kMaxFromStart_m)
    reasons.push_back(
        fmt::format("it is {:.2f} m from its start, and {:g} m are allowed: is its origin that of the file?",
                    from_start_m, Pilot::kMaxFromStart_m));
  if (std::abs(p_W.z()) > Pilot::kMaxFromStart_m)
    reasons.push_back(
        fmt::format("it stands at a height of {:.2f} m, and {:g} m are allowed: is its origin that of the file?",
                    p_W.z(), Pilot::kMaxFromStart_m));
  if (rules.start_W.z() - p_W.z() < Pilot::kLowestStart_m)
    reasons.push_back(fmt::format("its start is {:.2f} m above where it stands, and at least {:g} m are wanted",
                                  rules.start_W.z() - p_W.z(), Pilot::kLowestStart_m));
  if (rules.fence && !rules.fence->contains(rules.start_W))
    reasons.push_back("its start is beyond its fence");
  else if (rules.fence && !IsBelowTheTop(*rules.fence, p_W + Eigen::Vector3d(0, 0, rules.takeoff_m)))
    reasons.push_back("its way to its start (takeoff_m) leaves its fence");
  return reasons;
}

Pilot::Pilot(const PilotRules& rules)
    : rules_(rules), frame_(rules.frame), reference_(rules.start_W, Eigen::Vector3d::Zero(), rules.rate_hz) {}

void Pilot::Land(std::string why) {
  if (phase_ <= FlightPhase::kFound)
    wants_start_ = false;
  else if (!wants_land_)
    wants_land_ = std::move(why);
}

void Pilot::StopMotors(std::string why) {
  if (!std::exchange(wants_stop_, true)) words_.push_back("its motors are to stop: " + std::move(why));
}

void Pilot::Command(std::int64_t tick, const Eigen::Vector3d& a_W, Time now) {
  Eigen::Vector3d a = a_W;
  if (rules_.holds_height) a.z() = 0;
  if (commanded_at_ && now - *commanded_at_ > kMaxCommandAge && motion_W_) {
    Eigen::Vector3d p_W = motion_W_->p_WB, v_W = motion_W_->v_WB;
    if (rules_.holds_height) {
      p_W.z() = reference_.p_W().z();
      v_W.z() = 0;
    }
    reference_.Restart(tick, p_W, v_W);
  }
  reference_.Take(tick, a);
  commanded_at_ = now;
}

void Pilot::Enter(FlightPhase phase, Time now, std::string words) {
  phase_ = phase;
  since_ = now;
  if (phase == FlightPhase::kFound || phase == FlightPhase::kAbsent) {
    wants_start_ = false;
    wants_land_.reset();
  }
  asked_at_.reset();
  asked_.reset();
  near_since_.reset();
  words_.push_back(std::string(kFlightPhases.Name(phase)) + (words.empty() ? "" : ": " + std::move(words)));
}

void Pilot::Measure(const VehicleReport& report) {
  if (!report.motion_L || (motion_W_ && report.measured_at == measured_at_)) return;
  const Motion motion = *report.motion_L;
  if (phase_ < FlightPhase::kStreaming) {  // wherever it says that it is: it may have been carried, or switched on anew
    frame_ = rules_.frame;
  } else if (motion_L_ && report.resets != resets_) {
    const double dt_s = Seconds(report.measured_at - measured_at_);
    const Motion before = frame_.ToWorld(*motion_L_), after = frame_.ToWorld(motion);
    const Eigen::Vector3d jump_W = after.p_WB - (before.p_WB + before.v_WB * dt_s);
    frame_.p_WL -= jump_W;
    words_.push_back(fmt::format("its estimator has moved its origin by {} m, which is taken out", PlaceText(jump_W)));
  }
  resets_ = report.resets;
  motion_L_ = motion;
  motion_W_ = frame_.ToWorld(motion);
  measured_at_ = report.measured_at;
}

std::string Pilot::WhyLost(const VehicleReport& report, Time now) const {
  if (now - report.measured_at > kMaxAge)
    return fmt::format("nothing has been heard of where it is for {:.1f} s", Seconds(now - report.measured_at));
  if (now - report.status_at > kMaxStatusAge)
    return fmt::format("nothing has been heard of its status for {:.1f} s", Seconds(now - report.status_at));
  if (phase_ == FlightPhase::kStreaming) return "";
  // An order to land takes a while, and then it follows no more; landing is what its own failsafe may do, too.
  if (phase_ == FlightPhase::kLanding && (!has_obeyed_ || report.is_landing || !report.is_armed)) return "";
  if (!report.is_armed) return report.problem.empty() ? "it has disarmed itself" : report.problem;
  if (!report.follows)
    return "it follows no set-points any more: " +
           (report.problem.empty() ? "a pilot or its own failsafe has taken over" : report.problem);
  return "";
}

std::string Pilot::WhyToLand(const VehicleReport& report) const {
  if (wants_land_) return *wants_land_;
  if (!report.problem.empty()) return report.problem;
  if (report.battery && *report.battery < kBatteryToLand)
    return fmt::format("its battery is at {:.0f} %", 100 * *report.battery);
  const Eigen::Vector3d& p_W = motion_W_->p_WB;
  const bool is_up = phase_ >= FlightPhase::kReady;
  if (rules_.fence && !(is_up ? rules_.fence->contains(p_W) : IsBelowTheTop(*rules_.fence, p_W)))
    return "it is beyond its fence, at " + PlaceText(p_W);
  if (phase_ == FlightPhase::kFlying) {
    const double error_m = (p_W - reference_.p_W()).norm();
    if (error_m > rules_.max_error_m) return fmt::format("it is {:.2f} m from its reference", error_m);
    if (rules_.setpoint == SetpointKind::kReference && Farthest(frame_, reference_.p_W()) > rules_.farthest_m)
      return fmt::format("its reference is beyond {:g} m, as far as it can be sent", rules_.farthest_m);
  }
  return "";
}

Pilot::Turn Pilot::Look(const VehicleReport& report, Time now) {
  Measure(report);
  if (wants_stop_ && phase_ != FlightPhase::kAbsent) return StopNow(report, now);
  LookAtLife(report, now);
  return Act(report, now);
}

Pilot::Turn Pilot::StopNow(const VehicleReport& report, Time now) {
  if (!stops_since_) stops_since_ = now;
  const bool was_up = phase_ != FlightPhase::kLost && phase_ != FlightPhase::kLanded;
  if (was_up && !report.is_armed) Enter(FlightPhase::kLost, now, "its motors stand");
  if (was_up && report.is_armed && now - *stops_since_ > kStopWithin)
    Enter(FlightPhase::kLost, now, "its motors do not stop" + (report.refusal.empty() ? "" : ": " + report.refusal));
  if (!report.is_armed) return {};
  return {.order = Repeated(VehicleOrder::kStopMotors, now)};
}

void Pilot::LookAtLife(const VehicleReport& report, Time now) {
  switch (phase_) {
    case FlightPhase::kAbsent:
      if (!report.release.empty() && motion_W_ && now - report.measured_at <= kMaxAge)
        Enter(FlightPhase::kFound, now, fmt::format("{}, at {}", report.release, PlaceText(motion_W_->p_WB)));
      else if (report.problem != std::exchange(problem_, report.problem) && !problem_.empty())
        words_.push_back("absent: " + problem_);
      break;
    case FlightPhase::kFound:
      if (now - report.measured_at > kMaxAge) Enter(FlightPhase::kAbsent, now, "nothing is heard of it any more");
      break;
    case FlightPhase::kLanded:
    case FlightPhase::kLost:
      break;
    default:
      if (const std::string why = WhyLost(report, now); !why.empty()) return Enter(FlightPhase::kLost, now, why);
      if (phase_ < FlightPhase::kArmed || phase_ == FlightPhase::kLanding) break;
      if (const std::string why = WhyToLand(report); !why.empty()) Enter(FlightPhase::kLanding, now, why);
  }
}

Pilot::Turn Pilot::Act(const VehicleReport& report, Time now) {
  switch (phase_) {
    case FlightPhase::kFound:
      if (!std::exchange(wants_start_, false)) return {};
      if (const auto reasons = WhyNotToStart(rules_, report, motion_W_->p_WB); !reasons.empty()) {
        words_.push_back(fmt::format("it does not start: {}", fmt::join(reasons, "; ")));
        return {};
      }
      rest_W_ = motion_W_->p_WB;
      Enter(FlightPhase::kStreaming, now, "");
      return Stream(report, now);
    case FlightPhase::kStreaming:
      return Stream(report, now);
    case FlightPhase::kArmed:
      Enter(FlightPhase::kTakingOff, now, fmt::format("to its start, {}", PlaceText(rules_.start_W)));
      return TakeOff(now);
    case FlightPhase::kTakingOff:
    case FlightPhase::kReady:
      return TakeOff(now);
    case FlightPhase::kFlying:
      return Fly(now);
    case FlightPhase::kLanding:
      return LandNow(report, now);
    default:
      return {};
  }
}

std::optional<VehicleOrder> Pilot::Repeated(VehicleOrder order, Time now) {
  if (asked_ == order && now - *asked_at_ < kAskEvery) return std::nullopt;
  asked_ = order;
  asked_at_ = now;
  return order;
}

VehicleSetpoint Pilot::InFrame(const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W,
                               const Eigen::Vector3d& a_W) const {
  // What is not controlled is NaN, by axis: a turn about z would spread it.
  const Eigen::AngleAxisd turn(-frame_.yaw_WL, Eigen::Vector3d::UnitZ());
  const auto turned = [&](const Eigen::Vector3d& vector) {
    Eigen::Vector3d in_L = vector;
    in_L.head<2>() = turn.toRotationMatrix().topLeftCorner<2, 2>() * vector.head<2>();
    return in_L;
  };
  return {.p_L = turned(p_W - frame_.p_WL),
          .v_L = turned(v_W),
          .a_L = turned(a_W),
          .yaw_L = std::remainder(rules_.start_yaw - frame_.yaw_WL, 2 * std::numbers::pi)};
}

Pilot::Turn Pilot::Stream(const VehicleReport& report, Time now) {
  Turn turn{.setpoint = InFrame(rest_W_, Eigen::Vector3d::Zero(), kUncontrolled)};
  if (wants_land_) return LeaveStart(report, "it does not start: " + *wants_land_, now);
  if (report.follows && report.is_armed) {
    Enter(FlightPhase::kArmed, now, "");
    return turn;
  }
  if (now - since_ < kStreamFirst) return turn;
  if (now - since_ > kStreamFirst + kObeyWithin) {
    const std::string what = report.follows ? "it does not arm" : "it does not follow set-points";
    const std::string why =
        report.refusal.empty() ? "it has not answered (is system_id right? does it hear us?)" : report.refusal;
    return LeaveStart(report, what + ": " + why, now);
  }
  turn.order = Repeated(report.follows ? VehicleOrder::kArm : VehicleOrder::kFollow, now);
  return turn;
}

Pilot::Turn Pilot::LeaveStart(const VehicleReport& report, const std::string& why, Time now) {
  const bool was_armed = report.is_armed && !rules_.arms_itself;
  Enter(was_armed ? FlightPhase::kLanding : FlightPhase::kFound, now, why);
  return {};
}

Pilot::Turn Pilot::TakeOff(Time now) {
  const Eigen::Vector3d above_W = rest_W_ + Eigen::Vector3d(0, 0, rules_.takeoff_m);
  const OnPath path = phase_ == FlightPhase::kReady
                          ? OnPath{rules_.start_W, Eigen::Vector3d::Zero(), true}
                          : Along({rest_W_, above_W, rules_.start_W}, kTransferSpeed_m_per_s, Seconds(now - since_));
  if (phase_ == FlightPhase::kTakingOff) {
    const bool is_near = path.is_over && (motion_W_->p_WB - rules_.start_W).norm() <= kNear_m;
    if (!is_near) near_since_.reset();
    if (is_near && !near_since_) near_since_ = now;
    if (near_since_ && now - *near_since_ >= kSettle) Enter(FlightPhase::kReady, now, "");
  } else if (commanded_at_) {
    Enter(FlightPhase::kFlying, now, "");
    return Fly(now);
  }
  return {.setpoint = InFrame(path.p, path.v, kUncontrolled)};
}

Pilot::Turn Pilot::Fly(Time now) {
  const bool was_silent = std::exchange(is_silent_, now - *commanded_at_ > kMaxCommandAge);
  if (is_silent_ && !was_silent)
    words_.push_back(fmt::format("its agent has not commanded for {:.1f} s: nothing is sent until it does",
                                 Seconds(now - *commanded_at_)));
  if (!is_silent_ && was_silent) words_.push_back("its agent commands again");
  if (is_silent_) return {};
  Eigen::Vector3d p_W = reference_.p_W(), v_W = reference_.v_W(), a_W = reference_.a_W();
  const double z_W = p_W.z();
  if (rules_.setpoint != SetpointKind::kReference) p_W = kUncontrolled;
  if (rules_.setpoint == SetpointKind::kAcceleration) v_W = kUncontrolled;
  if (rules_.setpoint == SetpointKind::kVelocity) a_W = kUncontrolled;
  if (rules_.holds_height) {
    p_W.z() = z_W;
    v_W.z() = a_W.z() = kFree;
  }
  return {.setpoint = InFrame(p_W, v_W, a_W)};
}

Pilot::Turn Pilot::LandNow(const VehicleReport& report, Time now) {
  if (report.is_on_ground && !report.is_armed) {
    Enter(FlightPhase::kLanded, now, "");
    return {};
  }
  has_obeyed_ = has_obeyed_ || report.follows || report.is_landing;
  if (report.is_landing) return {};
  // Until it has taken the order it stands where it has come to a stop: an autopilot that gets nothing has another idea
  // of landing.
  if (!stop_) stop_ = {motion_W_->p_WB, motion_W_->v_WB};
  const double braking_s = stop_->v_W.norm() / kBraking_m_per_s2;
  const double t_s = std::min(Seconds(now - since_), braking_s);
  const Eigen::Vector3d v_W = braking_s > 0 ? (stop_->v_W * (1 - t_s / braking_s)).eval() : stop_->v_W;
  Turn turn{.setpoint = InFrame(stop_->p_W + t_s / 2 * (stop_->v_W + v_W), v_W, kUncontrolled)};
  if (t_s >= braking_s || !report.follows) turn.order = Repeated(VehicleOrder::kLand, now);
  return turn;
}

}  // namespace mascot
