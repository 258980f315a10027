#include "tests/fakes/px4/autopilot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mascot::fakes {
namespace {

constexpr double kSignsEvery_s = 0.5;       // at 2 Hz or more they are a row
constexpr double kSignsFor_s = 1.0;         // the row that offboard mode needs
constexpr double kDisarmUnflown_s = 10;     // COM_DISARM_PRFLT
constexpr double kDisarmLanded_s = 2;       // COM_DISARM_LAND
constexpr double kLandSpeed_m_per_s = 0.7;  // MPC_LAND_SPEED
constexpr double kSlow_m_per_s = 0.3;       // so slow it descends
constexpr double kP_per_s2 = 4, kD_per_s = 3;
constexpr double kMaxAcceleration_m_per_s2 = 6;
constexpr std::uint32_t kNavLand = 21, kDoSetMode = 176, kComponentArmDisarm = 400;
constexpr float kEvenInFlight = 21196;

// ENU to NED and back. Not those of vehicle/frames.h: a fake shares no mistake with what it tests. A NaN stays in its
// axis.
Eigen::Vector3d Swap(const Eigen::Vector3d& v) { return {v.y(), v.x(), -v.z()}; }

}  // namespace

Px4Autopilot::Px4Autopilot(const Px4Options& options)
    : options_(options), body_(options.place_ENU), hold_ENU_(body_.boot_ENU()) {}

Px4Odometry Px4Autopilot::odometry() const {
  const Motion motion = body_.motion();
  const Eigen::Matrix3d R_NW = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
  const Eigen::Matrix3d R_BF = Eigen::Vector3d(1, -1, -1).asDiagonal();
  return {.p_NED = Swap(motion.p_WB - body_.boot_ENU()) + shift_NED_,
          .v_NED = Swap(motion.v_WB),
          .w_FRD = R_BF * motion.w_WB_B,
          .q_NED_FRD = Eigen::Quaterniond(R_NW * motion.q_WB.toRotationMatrix() * R_BF),
          .is_in_ned = !options_.faults.has_no_heading,
          .reset_counter = resets_};
}

void Px4Autopilot::OnSignOfLife(const std::string& controlled) {
  if (options_.faults.hears_no_signs_of_life) return;
  if (controlled_ != controlled) words_.push_back("is told its " + controlled);
  controlled_ = controlled;
  if (t_s() - sign_of_life_s_ > kSignsEvery_s) signs_since_s_ = t_s();
  sign_of_life_s_ = t_s();
}

bool Px4Autopilot::MayFollow() const {
  return t_s() - sign_of_life_s_ <= kSignsEvery_s && t_s() - signs_since_s_ >= kSignsFor_s;
}

std::optional<Px4Autopilot::Result> Px4Autopilot::OnCommand(const Px4Command& command) {
  if (command.target_system != 0 && command.target_system != options_.system_id) return std::nullopt;
  switch (command.command) {
    case kNavLand:
      Enter(kLand, "lands");
      return kAccepted;
    case kDoSetMode:
      return SetMode(command);
    case kComponentArmDisarm:
      return Arm(command);
    default:
      return kUnsupported;
  }
}

Px4Autopilot::Result Px4Autopilot::SetMode(const Px4Command& command) {
  if (command.param1 != 1 || command.param2 != 6) return kDenied;
  if (is_armed_ && !MayFollow()) return kTemporarilyRejected;
  Enter(kOffboard, "offboard");  // disarmed, it accepts every mode, whether it can fly in it or not
  return kAccepted;
}

Px4Autopilot::Result Px4Autopilot::Arm(const Px4Command& command) {
  if (command.param1 == 0) {
    if (is_armed_ && !is_landed_ && command.param2 != kEvenInFlight) return kDenied;
    Disarm();
    return kAccepted;
  }
  if (is_armed_) return kAccepted;
  if (options_.faults.refuses_arming || (nav_state_ == kOffboard && !MayFollow())) return kTemporarilyRejected;
  is_armed_ = true;
  words_.push_back("armed");
  has_flown_ = false;
  armed_at_s_ = t_s();
  return kAccepted;
}

void Px4Autopilot::Enter(NavState state, const std::string& words) {
  if (nav_state_ == state) return;
  hold_ENU_ = body_.motion().p_WB;
  nav_state_ = state;
  is_braking_ = true;
  words_.push_back(words);
}

void Px4Autopilot::Disarm() {
  if (!std::exchange(is_armed_, false)) return;
  const Eigen::Vector3d way_ENU = body_.motion().p_WB - body_.boot_ENU();
  words_.push_back(
      fmt::format("disarmed, {:.2f} m east and {:.2f} m north of where it was switched on; highest: {:.2f} m",
                  way_ENU.x(), way_ENU.y(), highest_m_));
}

void Px4Autopilot::Step() {
  ++steps_;
  const Px4Faults& faults = options_.faults;
  if (resets_ == 0 && body_.flown_s() >= faults.reset_at_s) {
    shift_NED_ = faults.reset_NED;
    ++resets_;
  }
  LookAtFailsafes();
  const bool idles = nav_state_ != kOffboard && is_landed_;
  if (is_armed_ && !idles)
    body_.Step(WantedAcceleration_ENU());
  else
    body_.Step({});
  LookAtGround();
}

void Px4Autopilot::LookAtFailsafes() {
  if (body_.flown_s() >= options_.faults.pilot_at_s && nav_state_ == kOffboard) Enter(kPosition, "its pilot has it");
  if (is_armed_ && nav_state_ == kOffboard && t_s() - sign_of_life_s_ > options_.offboard_loss_s)
    Enter(kLand, "no sign of life: lands");
  if (!is_armed_) return;
  if (!has_flown_ && t_s() - armed_at_s_ > kDisarmUnflown_s) Disarm();
  if (has_flown_ && body_.resting_s() > kDisarmLanded_s) Disarm();
}

void Px4Autopilot::LookAtGround() {
  constexpr double kFor_s = 0.3;
  is_landed_ = body_.resting_s() >= kFor_s;
  highest_m_ = std::max(highest_m_, body_.height_m());
  has_flown_ = has_flown_ || body_.height_m() > Quadrotor::kOffTheGround_m;
}

/// As its position controller does: what is not controlled is not looked at.
Eigen::Vector3d Px4Autopilot::WantedAcceleration_ENU() {
  const Motion motion = body_.motion();
  Eigen::Vector3d p = hold_ENU_, v = Eigen::Vector3d::Zero(), a = Eigen::Vector3d::Zero();
  if (nav_state_ == kLand) {
    p.z() = std::numeric_limits<double>::quiet_NaN();
    is_braking_ = is_braking_ && motion.v_WB.head<2>().norm() > kSlow_m_per_s;
    if (is_braking_) hold_ENU_ = motion.p_WB;
    v.z() = is_braking_ ? 0 : -kLandSpeed_m_per_s;
  } else if (nav_state_ == kOffboard && setpoint_) {
    p = Swap(setpoint_->p_NED - shift_NED_) + body_.boot_ENU();
    v = Swap(setpoint_->v_NED);
    a = Swap(setpoint_->a_NED);
  }
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const bool has_p = std::isfinite(p[k]), has_v = std::isfinite(v[k]);
    if (std::isfinite(a[k])) wanted[k] += a[k];
    if (has_p) wanted[k] += kP_per_s2 * (p[k] - motion.p_WB[k]);
    if (has_p || has_v) wanted[k] += kD_per_s * ((has_v ? v[k] : 0) - motion.v_WB[k]);
  }
  return wanted.cwiseMax(-kMaxAcceleration_m_per_s2).cwiseMin(kMaxAcceleration_m_per_s2);
}

}  // namespace mascot::fakes
