#include "tests/fakes/crazyswarm/crazyflie.h"

#include <cmath>

namespace mascot::fakes {
namespace {

constexpr double kLevelAfter_s = 0.5, kStopAfter_s = 2.0;  // COMMANDER_WDT_TIMEOUT_STABILIZE, _SHUTDOWN
constexpr double kP_per_s2 = 6, kD_per_s = 4, kMaxAcceleration_m_per_s2 = 6;

}  // namespace

Crazyflie::Crazyflie(const CrazyflieOptions& options) : options_(options), body_(options.place_W) {}

void Crazyflie::Arm(bool arm) {
  if (arm && (options_.faults.refuses_arming || is_tumbled_ || is_locked_)) return;
  is_armed_ = arm;
}

void Crazyflie::Stream(const CrazyflieSetpoint& setpoint) {
  streamed_ = setpoint;
  streamed_at_s_ = t_s();
}

std::uint16_t Crazyflie::supervisor() const {
  std::uint16_t bits = 0;
  if (!options_.faults.refuses_arming && !is_armed_ && !is_tumbled_ && !is_locked_) bits |= kCanBeArmed;
  if (is_armed_ && !is_locked_) bits |= kIsArmed;
  if (is_armed_ && !is_tumbled_ && !is_locked_) bits |= kCanFly;
  if (motors_run_) bits |= kIsFlying;
  if (is_tumbled_) bits |= kIsTumbled;
  if (is_locked_) bits |= kIsLocked;
  return bits;
}

void Crazyflie::Step() {
  ++steps_;
  if (body_.flown_s() >= options_.faults.tumbles_at_s && motors_run_) is_tumbled_ = true;
  const auto wanted = WantedAcceleration_W();
  motors_run_ = wanted.has_value();
  body_.Step(wanted);
}

std::optional<Eigen::Vector3d> Crazyflie::WantedAcceleration_W() {
  if (!is_armed_ || is_tumbled_ || is_locked_ || !streamed_) return std::nullopt;
  const double age_s = t_s() - streamed_at_s_;
  if (age_s > kStopAfter_s) {
    streamed_.reset();
    return std::nullopt;
  }
  if (age_s > kLevelAfter_s) return Eigen::Vector3d::Zero();  // level, with the thrust that it hovers with
  const Motion motion = body_.motion();
  Eigen::Vector3d wanted = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const bool has_p = std::isfinite(streamed_->p_W[k]);
    if (std::isfinite(streamed_->a_W[k])) wanted[k] += streamed_->a_W[k];
    if (has_p) wanted[k] += kP_per_s2 * (streamed_->p_W[k] - motion.p_WB[k]);
    wanted[k] += kD_per_s * ((std::isfinite(streamed_->v_W[k]) ? streamed_->v_W[k] : 0) - motion.v_WB[k]);
  }
  return wanted.cwiseMax(-kMaxAcceleration_m_per_s2).cwiseMin(kMaxAcceleration_m_per_s2);
}

}  // namespace mascot::fakes
