#include "orchestrator/crazyswarm/commander.h"

#include <algorithm>
#include <limits>

namespace mascot::crazyswarm {
namespace {

const Eigen::Vector3d kUncontrolled = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

/// From rest to rest along a line, in time s of 0 to 1: the share of the way, its first and second derivative.
struct Share {
  double share, rate, curvature;
};
Share FromRestToRest(double s) {
  return {s * s * s * (10 + s * (-15 + 6 * s)), 30 * s * s * (1 + s * (-2 + s)), 60 * s * (1 + s * (-3 + 2 * s))};
}

}  // namespace

void Commander::Arm(bool arm) {
  is_armed_ = arm && !is_locked_;
  if (!is_armed_) motors_run_ = false;
}

void Commander::Plan(const Eigen::Vector3d& to_W, double duration_s, const Eigen::Vector3d& p_W, double now) {
  if (!is_armed_) return;
  from_W_ = p_W;
  to_W_ = to_W;
  begin_s_ = now;
  duration_s_ = duration_s;
  lands_ = false;
  trajectory_ = {};
}

void Commander::TakeOff(double height_m, double duration_s, const Eigen::Vector3d& p_W, double now) {
  Plan({p_W.x(), p_W.y(), height_m}, duration_s, p_W, now);
  motors_run_ = is_armed_;
}

void Commander::Land(double height_m, double duration_s, const Eigen::Vector3d& p_W, double now) {
  if (!motors_run_) return;
  Plan({p_W.x(), p_W.y(), height_m}, duration_s, p_W, now);
  lands_ = true;
}

void Commander::GoTo(const Eigen::Vector3d& goal_W, bool relative, double duration_s, const Eigen::Vector3d& p_W,
                     double now) {
  if (motors_run_) Plan(relative ? Eigen::Vector3d(p_W + goal_W) : goal_W, duration_s, p_W, now);
}

void Commander::Follow(const Trajectory& trajectory, double timescale, bool reversed, bool relative,
                       const Eigen::Vector3d& p_W, double now) {
  if (!motors_run_ || trajectory.empty()) return;
  const Eigen::Vector3d begin = trajectory.At(reversed ? trajectory.duration_s() : 0).p;
  const Eigen::Vector3d end = trajectory.At(reversed ? 0 : trajectory.duration_s()).p;
  const Eigen::Vector3d shift = relative ? Eigen::Vector3d(p_W - begin) : Eigen::Vector3d::Zero();
  Plan(end + shift, timescale * trajectory.duration_s(), p_W, now);
  trajectory_ = trajectory;
  timescale_ = timescale;
  is_reversed_ = reversed;
  shift_W_ = shift;
}

Setpoint Commander::OnTrajectory(double now) const {
  const double t_s = (now - begin_s_) / timescale_;
  const double sign = is_reversed_ ? -1 : 1;
  const Trajectory::Point point = trajectory_.At(is_reversed_ ? trajectory_.duration_s() - t_s : t_s);
  return {point.p + shift_W_, sign * point.v / timescale_, point.a / (timescale_ * timescale_)};
}

void Commander::Emergency() {
  is_locked_ = true;
  Arm(false);
  streamed_.reset();
}

void Commander::NotifySetpointsStop(const Eigen::Vector3d& p_W, double now) {
  if (!streamed_) return;
  from_W_ = to_W_ = streamed_->p_W.array().isFinite().select(streamed_->p_W, p_W);
  begin_s_ = now;
  duration_s_ = 0;
  lands_ = false;
  trajectory_ = {};
  streamed_.reset();
}

void Commander::Stream(const Setpoint& setpoint, double now) {
  if (!is_armed_) return;
  streamed_ = setpoint;
  streamed_at_s_ = now;
  motors_run_ = true;
}

std::optional<Setpoint> Commander::At(double now) {
  if (!motors_run_) return std::nullopt;
  if (streamed_) {
    const double age_s = now - streamed_at_s_;
    if (age_s <= kLevelAfter_s) return streamed_;
    if (age_s <= kStopAfter_s) return Setpoint{kUncontrolled, kUncontrolled, Eigen::Vector3d::Zero()};
    Emergency();
    return std::nullopt;
  }
  const double s = duration_s_ > 0 ? std::clamp((now - begin_s_) / duration_s_, 0.0, 1.0) : 1;
  if (s >= 1 && lands_) {
    motors_run_ = false;
    return std::nullopt;
  }
  if (!trajectory_.empty()) return OnTrajectory(now);
  const Share share = FromRestToRest(s);
  const Eigen::Vector3d way = to_W_ - from_W_;
  const double rate = duration_s_ > 0 ? share.rate / duration_s_ : 0;
  const double curvature = duration_s_ > 0 ? share.curvature / (duration_s_ * duration_s_) : 0;
  return Setpoint{from_W_ + share.share * way, rate * way, curvature * way};
}

}  // namespace mascot::crazyswarm
