#include "tests/fakes/ardupilot/autopilot.h"

#include <algorithm>

namespace mascot::fakes {
namespace {

constexpr double kVelocityLasts_s = 3;       // GUID_TIMEOUT
constexpr double kDisarmUnflown_s = 10;      // DISARM_DELAY
constexpr double kDisarmLanded_s = 1;        // on the ground in mode LAND
constexpr double kLandSpeed_m_per_s = 0.5;   // LAND_SPEED
constexpr double kClimbSpeed_m_per_s = 1.0;  // of a take-off
constexpr double kSlow_m_per_s = 0.3;        // so slow it descends
constexpr double kTakenOff_m = 0.1;          // below the height of a take-off: then it is over
constexpr double kP_per_s2 = 4, kD_per_s = 3, kMaxAcceleration_m_per_s2 = 6;

}  // namespace

ArdupilotAutopilot::ArdupilotAutopilot(const ArdupilotOptions& options)
    : options_(options), body_(options.place_ENU), hold_ENU_(body_.boot_ENU()) {}

Motion ArdupilotAutopilot::motion() const {
  Motion motion = body_.motion();
  motion.p_WB -= body_.boot_ENU();
  return motion;
}

std::vector<std::uint8_t> ArdupilotAutopilot::failsafes() const {
  if (body_.flown_s() < options_.faults.battery_low_at_s) return {};
  return {kBatteryFailsafe};
}

bool ArdupilotAutopilot::SetMode(int mode) {
  if (mode != kStabilize && mode != kGuided && mode != kLoiter && mode != kLand) return false;
  Enter(static_cast<Mode>(mode));
  return true;
}

void ArdupilotAutopilot::Enter(Mode mode) {
  if (mode_ == mode) return;
  mode_ = mode;
  is_braking_ = true;
  hold_ENU_ = body_.motion().p_WB;
  takeoff_m_.reset();
  velocity_at_s_ = t_s() - kVelocityLasts_s - 1;
}

bool ArdupilotAutopilot::Arm(bool arm) {
  if (!arm) {
    if (is_flying()) return false;
    is_armed_ = false;
    return true;
  }
  if (options_.faults.refuses_arming || mode_ == kLand || !failsafes().empty()) return false;
  if (is_armed_) return true;
  is_armed_ = true;
  has_flown_ = false;
  armed_at_s_ = t_s();
  return true;
}

bool ArdupilotAutopilot::TakeOff(double height_m) {
  if (!is_armed_ || mode_ != kGuided || is_flying() || !(height_m > 0)) return false;
  takeoff_m_ = height_m;
  hold_ENU_ = body_.motion().p_WB;
  return true;
}

void ArdupilotAutopilot::SetVelocity(const Eigen::Vector3d& v_ENU) {
  if (mode_ != kGuided || !is_flying()) return;
  takeoff_m_.reset();
  velocity_ENU_ = v_ENU;
  velocity_at_s_ = t_s();
}

void ArdupilotAutopilot::Step() {
  ++steps_;
  if (body_.flown_s() >= options_.faults.pilot_at_s && mode_ == kGuided) Enter(kLoiter);
  if (!failsafes().empty() && is_flying()) Enter(kLand);
  if (is_armed_ && !has_flown_ && !takeoff_m_ && t_s() - armed_at_s_ > kDisarmUnflown_s) is_armed_ = false;
  if (is_armed_ && has_flown_ && body_.resting_s() > kDisarmLanded_s) is_armed_ = false;
  const bool is_to_fly = is_armed_ && (is_flying() || takeoff_m_);
  if (is_to_fly)
    body_.Step(WantedAcceleration_ENU());
  else
    body_.Step({});
  has_flown_ = has_flown_ || is_flying();
}

Eigen::Vector3d ArdupilotAutopilot::WantedAcceleration_ENU() {
  const Motion motion = body_.motion();
  Eigen::Vector3d v = Eigen::Vector3d::Zero(), p = hold_ENU_;
  bool holds_xy = true, holds_z = true;
  if (mode_ == kLand) {
    is_braking_ = is_braking_ && motion.v_WB.head<2>().norm() > kSlow_m_per_s;
    if (is_braking_) p = hold_ENU_ = motion.p_WB;
    v.z() = is_braking_ ? 0 : -kLandSpeed_m_per_s;
    holds_z = false;
  } else if (takeoff_m_) {
    const double top = body_.boot_ENU().z() + *takeoff_m_;
    if (motion.p_WB.z() > top - kTakenOff_m) {
      hold_ENU_.z() = top;
      takeoff_m_.reset();
      p = hold_ENU_;
    } else {
      v.z() = std::min(kClimbSpeed_m_per_s, 2 * (top - motion.p_WB.z()));
      holds_z = false;
    }
  } else if (mode_ == kGuided && t_s() - velocity_at_s_ <= kVelocityLasts_s) {
    v = velocity_ENU_;
    holds_xy = holds_z = false;
    hold_ENU_ = motion.p_WB;
  }
  Eigen::Vector3d wanted = kD_per_s * (v - motion.v_WB);
  if (holds_xy) wanted.head<2>() += kP_per_s2 * (p - motion.p_WB).head<2>();
  if (holds_z) wanted.z() += kP_per_s2 * (p - motion.p_WB).z();
  return wanted.cwiseMax(-kMaxAcceleration_m_per_s2).cwiseMin(kMaxAcceleration_m_per_s2);
}

}  // namespace mascot::fakes
