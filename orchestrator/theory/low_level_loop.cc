#include "orchestrator/theory/low_level_loop.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/sines.h"

namespace mascot {
namespace {

// As in agent/controllers/quadrotor.cc: the largest correction towards the reference, and the least part of the thrust
// that points up for which the exact inversion raises it.
constexpr double kMaxCorrection = 1.0;
constexpr double kMinUpright = 0.5;
// More steps of the physics in a control period change nothing that counts here.
constexpr int kMaxStepsOfPeriod = 10;

double PdAccel(PdGains gains, double error, double rate) { return gains.kp * error + gains.kd * rate; }

}  // namespace

LowLevelLoop::LowLevelLoop(const Experiment& experiment, const AgentConfig& agent, const LoopError& error)
    : agent_(agent),
      error_(error),
      h_(experiment.period_s()),
      gravity_(experiment.physics.gravity_m_per_s2),
      steps_(std::min(experiment.steps_per_tick(), kMaxStepsOfPeriod)),
      holds_altitude_(agent.law.axes == Axes::kXy),
      wind_W_(experiment.physics.wind.mean_m_per_s),
      p_ref_W_(agent.p_W),
      v_ref_W_(agent.v_W),
      lift_n_(std::min(agent.airframe.mass_kg * gravity_, agent.airframe.max_thrust_n)) {
  const double heading_rad = agent.traits().turns_to_heading ? agent.control.heading_rad : agent.heading_rad;
  R_WH_ = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  motion_.p_WB = agent.p_W;
  motion_.v_WB = agent.v_W;
  motion_.q_WB = R_WH_;
  if (holds_altitude_) v_ref_W_.z() = 0;
}

void LowLevelLoop::Step(const Command& command) {
  const Eigen::Vector3d before_W = motion_.v_WB;
  if (agent_.traits().driven_by == Wanted::kVelocity)
    Glide(command.v_limited_W);
  else if (!agent_.traits().has_airframe)
    Accelerate(command.a_limited_W);
  else
    Fly(command.a_limited_W);
  motion_.a_WB = (motion_.v_WB - before_W) / h_;
}

void LowLevelLoop::Glide(const Eigen::Vector3d& v_W) {
  motion_.v_WB = (1 + error_.push) * v_W;
  motion_.p_WB += h_ * motion_.v_WB;
}

void LowLevelLoop::Accelerate(const Eigen::Vector3d& a_W) {
  Eigen::Vector3d a_now_W = (1 + error_.push) * a_W;
  if (holds_altitude_)
    a_now_W.z() = PdAccel(agent_.airframe.altitude, agent_.p_W.z() - motion_.p_WB.z(), -motion_.v_WB.z());
  motion_.p_WB += h_ * motion_.v_WB + h_ * h_ / 2 * a_now_W;
  motion_.v_WB += h_ * a_now_W;
}

Eigen::Vector3d LowLevelLoop::Correction_W() {
  Eigen::Vector3d correction_W;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const PdGains& gains = axis < 2 ? agent_.airframe.position : agent_.airframe.altitude;
    correction_W[axis] = PdAccel(gains, p_ref_W_[axis] - motion_.p_WB[axis], v_ref_W_[axis] - motion_.v_WB[axis]);
    if (std::abs(correction_W[axis]) <= kMaxCorrection || (axis == 2 && holds_altitude_)) continue;
    p_ref_W_[axis] = motion_.p_WB[axis];
    v_ref_W_[axis] = motion_.v_WB[axis];
    correction_W[axis] = 0;
  }
  return correction_W;
}

// Roll and pitch that give a_W, within the limit of the tilt.
Eigen::Vector2d LowLevelLoop::Target_rad(const Eigen::Vector3d& a_W) {
  const Eigen::Vector3d a_H = R_WH_.transpose() * a_W;
  const double least = agent_.airframe.MinCommandedThrust() / agent_.airframe.mass_kg;
  const bool exact = agent_.control.inversion == Inversion::kExact;
  const double up = std::max(exact ? a_H.z() + gravity_ : gravity_, least);
  Eigen::Vector2d target_rad(-a_H.y() / up, a_H.x() / up);
  if (exact) target_rad = {std::atan2(-a_H.y(), std::hypot(a_H.x(), up)), std::atan2(a_H.x(), up)};
  const double limit = agent_.airframe.tilt_limit_rad;
  is_tilt_cut_ = target_rad.cwiseAbs().maxCoeff() > limit;
  return target_rad.cwiseMin(limit).cwiseMax(-limit);
}

double LowLevelLoop::Thrust_n(double a_up) const {
  double thrust_n = agent_.airframe.mass_kg * (a_up + gravity_);
  if (agent_.control.inversion == Inversion::kExact)
    thrust_n /= std::max(std::cos(tilt_rad_.x()) * std::cos(tilt_rad_.y()), kMinUpright);
  return std::clamp(thrust_n, agent_.airframe.MinCommandedThrust(), agent_.airframe.MaxCommandedThrust());
}

// What the PD law of the tilt asks for, as far as the rotors can give both at once: each of roll and pitch takes a
// pair of them, which gives (arm / 2) min(thrust, largest thrust - thrust) at most.
Eigen::Vector2d LowLevelLoop::TurnAccel(const Eigen::Vector2d& target_rad, double thrust_n) const {
  const Airframe& body = agent_.airframe;
  const double fastest =
      body.attitude.kd > 0 ? body.attitude.kd * Airframe::kMaxTurnRate : std::numeric_limits<double>::infinity();
  const Eigen::Vector2d towards = body.attitude.kp * (target_rad - tilt_rad_);
  const Eigen::Vector2d wanted = towards.cwiseMin(fastest).cwiseMax(-fastest) - body.attitude.kd * tilt_rate_;
  const double torque_nm = body.arm_m / 2 * std::min(thrust_n, body.max_thrust_n - thrust_n);
  double share = 1;
  for (Eigen::Index axis = 0; axis < 2; ++axis)
    if (const double asked_nm = std::abs(wanted[axis]) * body.inertia_kg_m2[axis]; asked_nm > torque_nm)
      share = std::min(share, torque_nm / asked_nm);
  return share * wanted;
}

Eigen::Vector3d LowLevelLoop::ThrustDirection_W() const {
  const auto [sin, cos] = SinesAndCosinesOf(tilt_rad_);  // roll, pitch
  return R_WH_ * Eigen::Vector3d((1 + error_.push) * cos.x() * sin.y(), -(1 + error_.push) * sin.x(), cos.x() * cos.y());
}

void LowLevelLoop::Move(double thrust_n, const Eigen::Vector2d& turn_accel) {
  const Airframe& body = agent_.airframe;
  const double dt = h_ / steps_, lag_s = body.rotor_time_constant_s;
  const double followed = lag_s > 0 ? -std::expm1(-dt / lag_s) : 1;
  const double drag_per_s = body.linear_drag_kg_per_s / body.mass_kg;
  for (int step = 0; step < steps_; ++step) {
    lift_n_ += followed * (thrust_n - lift_n_);
    turning_ += followed * (turn_accel - turning_);
    Eigen::Vector3d a_W = lift_n_ / body.mass_kg * ThrustDirection_W() - drag_per_s * (motion_.v_WB - wind_W_);
    a_W.z() -= gravity_;
    motion_.p_WB += dt * motion_.v_WB + dt * dt / 2 * a_W;
    motion_.v_WB += dt * a_W;
    tilt_rate_ += dt * (1 + error_.turn) * turning_;
    tilt_rad_ += dt * tilt_rate_;
  }
}

void LowLevelLoop::Fly(const Eigen::Vector3d& a_W) {
  const Airframe& body = agent_.airframe;
  const Eigen::Vector3d ideal_W(a_W.x(), a_W.y(), holds_altitude_ ? 0 : a_W.z());
  Eigen::Vector3d wanted_W = ideal_W + Correction_W();
  if (agent_.control.drag_compensation) wanted_W += body.linear_drag_kg_per_s / body.mass_kg * motion_.v_WB;
  p_ref_W_ += h_ * v_ref_W_ + h_ * h_ / 2 * ideal_W;
  v_ref_W_ += h_ * ideal_W;
  const double thrust_n = Thrust_n(wanted_W.z());
  Move(thrust_n, TurnAccel(Target_rad(wanted_W), thrust_n));
  motion_.q_WB = R_WH_ * Eigen::AngleAxisd(tilt_rad_.y(), Eigen::Vector3d::UnitY()) *
                 Eigen::AngleAxisd(tilt_rad_.x(), Eigen::Vector3d::UnitX());
  motion_.w_WB_B = {tilt_rate_.x(), tilt_rate_.y(), 0};
}

}  // namespace mascot
