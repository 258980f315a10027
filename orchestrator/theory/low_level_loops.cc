#include "orchestrator/theory/low_level_loops.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace mascot {
namespace {

using F = LoopField;

// As in agent/controllers/quadrotor.cc: the largest correction towards the reference, and the least part of the thrust
// that points up for which the exact inversion raises it.
constexpr double kMaxCorrection = 1.0;
constexpr double kMinUpright = 0.5;
// More steps of the physics in a control period change nothing that counts here.
constexpr int kMaxStepsOfPeriod = 10;

double PdAccel(PdGains gains, double error, double rate) { return gains.kp * error + gains.kd * rate; }

/// The kernels that this processor can run, the one with most lanes first.
std::vector<LoopKernel> Kernels() {
  std::vector<LoopKernel> kernels;
#ifdef MASCOT_AVX
  if (__builtin_cpu_supports("avx")) kernels.push_back(LoopsByAvx());
#endif
  kernels.push_back(LoopsByDefault());
  return kernels;
}

int Quadrotors(const Experiment& experiment) {
  return static_cast<int>(
      std::ranges::count_if(experiment.agents, [](const AgentConfig& agent) { return agent.traits().has_airframe; }));
}

}  // namespace

LowLevelLoops::LowLevelLoops(const Experiment& experiment, const LoopError& error)
    : error_(error),
      h_(experiment.period_s()),
      gravity_(experiment.physics.gravity_m_per_s2),
      steps_(std::min(experiment.steps_per_tick(), kMaxStepsOfPeriod)),
      motions_(experiment.agents.size()),
      before_W_(experiment.agents.size()),
      kernel_(KernelWith(Kernels(), Quadrotors(experiment))),
      numbers_(static_cast<std::size_t>(Quadrotors(experiment)), F::kCount, kernel_.lanes) {
  std::size_t quadrotors = 0;
  for (const AgentConfig& agent : experiment.agents) {
    const double heading_rad = agent.traits().turns_to_heading ? agent.control.heading_rad : agent.heading_rad;
    Body& body =
        bodies_.emplace_back(Body{.agent = agent,
                                  .R_WH = Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
                                  .holds_altitude = agent.law.axes == Axes::kXy,
                                  .p_ref_W = agent.p_W,
                                  .v_ref_W = agent.v_W});
    if (body.holds_altitude) body.v_ref_W.z() = 0;
    Motion& motion = motions_[bodies_.size() - 1];
    motion.p_WB = agent.p_W;
    motion.v_WB = agent.v_W;
    motion.q_WB = body.R_WH;
    if (!agent.traits().has_airframe) continue;
    body.place = quadrotors++;
    Begin(experiment, body);
  }
  for (std::size_t k = 0; k < numbers_.blocks() * numbers_.lanes(); ++k)  // also those that fill up the last block
    if (k >= quadrotors) numbers_.At(k, F::kMass) = 1;
}

void LowLevelLoops::Begin(const Experiment& experiment, const Body& body) {
  const Airframe& airframe = body.agent.airframe;
  const double lag_s = airframe.rotor_time_constant_s;
  const auto at = [&](int field) -> double& { return numbers_.At(body.place, field); };
  Put(body.agent.p_W, body.place, F::kP);
  Put(body.agent.v_W, body.place, F::kV);
  for (int row = 0; row < 3; ++row) Put(body.R_WH.row(row), body.place, F::kR + 3 * row);
  Put(experiment.physics.wind.mean_m_per_s, body.place, F::kWind);
  at(F::kLift) = std::min(airframe.mass_kg * gravity_, airframe.max_thrust_n);
  at(F::kMass) = airframe.mass_kg;
  at(F::kFollowed) = lag_s > 0 ? -std::expm1(-(h_ / steps_) / lag_s) : 1;
  at(F::kDragPerS) = airframe.linear_drag_kg_per_s / airframe.mass_kg;
  at(F::kMorePush) = 1 + error_.push;
  at(F::kMoreTurn) = 1 + error_.turn;
}

double LowLevelLoops::tilt_rad(std::size_t body) const {
  return bodies_[body].agent.traits().has_airframe ? Two(bodies_[body].place, F::kTilt).cwiseAbs().maxCoeff() : 0;
}

void LowLevelLoops::Step(std::span<const Command> commands) {
  tilts_cut_ = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    before_W_[i] = motions_[i].v_WB;
    if (body.agent.traits().driven_by == Wanted::kVelocity)
      Glide(commands[i].v_limited_W, motions_[i]);
    else if (!body.agent.traits().has_airframe)
      Accelerate(body, commands[i].a_limited_W, motions_[i]);
    else
      Hold(body, commands[i].a_limited_W, motions_[i]);
  }
  kernel_.move(numbers_.Block(0), numbers_.blocks(),
               {.steps = steps_, .dt_s = h_ / steps_, .gravity_m_per_s2 = gravity_});
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].agent.traits().has_airframe) Take(bodies_[i], motions_[i]);
    motions_[i].a_WB = (motions_[i].v_WB - before_W_[i]) / h_;
  }
}

void LowLevelLoops::Glide(const Eigen::Vector3d& v_W, Motion& motion) const {
  motion.v_WB = (1 + error_.push) * v_W;
  motion.p_WB += h_ * motion.v_WB;
}

void LowLevelLoops::Accelerate(const Body& body, const Eigen::Vector3d& a_W, Motion& motion) const {
  Eigen::Vector3d a_now_W = (1 + error_.push) * a_W;
  if (body.holds_altitude)
    a_now_W.z() = PdAccel(body.agent.airframe.altitude, body.agent.p_W.z() - motion.p_WB.z(), -motion.v_WB.z());
  motion.p_WB += h_ * motion.v_WB + h_ * h_ / 2 * a_now_W;
  motion.v_WB += h_ * a_now_W;
}

Eigen::Vector3d LowLevelLoops::Correction_W(Body& body, const Motion& motion) const {
  Eigen::Vector3d correction_W;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const PdGains& gains = axis < 2 ? body.agent.airframe.position : body.agent.airframe.altitude;
    correction_W[axis] = PdAccel(gains, body.p_ref_W[axis] - motion.p_WB[axis], body.v_ref_W[axis] - motion.v_WB[axis]);
    if (std::abs(correction_W[axis]) <= kMaxCorrection || (axis == 2 && body.holds_altitude)) continue;
    body.p_ref_W[axis] = motion.p_WB[axis];
    body.v_ref_W[axis] = motion.v_WB[axis];
    correction_W[axis] = 0;
  }
  return correction_W;
}

// Roll and pitch that give a_W, within the limit of the tilt.
Eigen::Vector2d LowLevelLoops::Target_rad(const Body& body, const Eigen::Vector3d& a_W) {
  const Airframe& airframe = body.agent.airframe;
  const Eigen::Vector3d a_H = body.R_WH.transpose() * a_W;
  const double least = airframe.MinCommandedThrust() / airframe.mass_kg;
  const bool exact = body.agent.control.inversion == Inversion::kExact;
  const double up = std::max(exact ? a_H.z() + gravity_ : gravity_, least);
  Eigen::Vector2d target_rad(-a_H.y() / up, a_H.x() / up);
  if (exact) target_rad = {std::atan2(-a_H.y(), std::hypot(a_H.x(), up)), std::atan2(a_H.x(), up)};
  const double limit = airframe.tilt_limit_rad;
  if (target_rad.cwiseAbs().maxCoeff() > limit) ++tilts_cut_;
  return target_rad.cwiseMin(limit).cwiseMax(-limit);
}

double LowLevelLoops::Thrust_n(const Body& body, double a_up) const {
  const Airframe& airframe = body.agent.airframe;
  double thrust_n = airframe.mass_kg * (a_up + gravity_);
  if (body.agent.control.inversion == Inversion::kExact) {
    const Eigen::Vector2d tilt_rad = Two(body.place, F::kTilt);
    thrust_n /= std::max(std::cos(tilt_rad.x()) * std::cos(tilt_rad.y()), kMinUpright);
  }
  return std::clamp(thrust_n, airframe.MinCommandedThrust(), airframe.MaxCommandedThrust());
}

// What the PD law of the tilt asks for, as far as the rotors can give both at once: each of roll and pitch takes a
// pair of them, which gives (arm / 2) min(thrust, largest thrust - thrust) at most.
Eigen::Vector2d LowLevelLoops::TurnAccel(const Body& body, const Eigen::Vector2d& target_rad, double thrust_n) const {
  const Airframe& airframe = body.agent.airframe;
  const double fastest = airframe.attitude.kd > 0 ? airframe.attitude.kd * Airframe::kMaxTurnRate
                                                  : std::numeric_limits<double>::infinity();
  const Eigen::Vector2d towards = airframe.attitude.kp * (target_rad - Two(body.place, F::kTilt));
  const Eigen::Vector2d wanted =
      towards.cwiseMin(fastest).cwiseMax(-fastest) - airframe.attitude.kd * Two(body.place, F::kTiltRate);
  const double torque_nm = airframe.arm_m / 2 * std::min(thrust_n, airframe.max_thrust_n - thrust_n);
  double share = 1;
  for (Eigen::Index axis = 0; axis < 2; ++axis)
    if (const double asked_nm = std::abs(wanted[axis]) * airframe.inertia_kg_m2[axis]; asked_nm > torque_nm)
      share = std::min(share, torque_nm / asked_nm);
  return share * wanted;
}

/// The thrust and the turning that are held until the next tick.
void LowLevelLoops::Hold(Body& body, const Eigen::Vector3d& a_W, const Motion& motion) {
  const Airframe& airframe = body.agent.airframe;
  const Eigen::Vector3d ideal_W(a_W.x(), a_W.y(), body.holds_altitude ? 0 : a_W.z());
  Eigen::Vector3d wanted_W = ideal_W + Correction_W(body, motion);
  if (body.agent.control.drag_compensation) wanted_W += airframe.linear_drag_kg_per_s / airframe.mass_kg * motion.v_WB;
  body.p_ref_W += h_ * body.v_ref_W + h_ * h_ / 2 * ideal_W;
  body.v_ref_W += h_ * ideal_W;
  const double thrust_n = Thrust_n(body, wanted_W.z());
  numbers_.At(body.place, F::kThrust) = thrust_n;
  Put(TurnAccel(body, Target_rad(body, wanted_W), thrust_n), body.place, F::kTurn);
}

/// The motion of a quadrotor after a tick.
void LowLevelLoops::Take(const Body& body, Motion& motion) const {
  for (int k = 0; k < 3; ++k) {
    motion.p_WB[k] = numbers_.At(body.place, F::kP + k);
    motion.v_WB[k] = numbers_.At(body.place, F::kV + k);
  }
  const Eigen::Vector2d tilt_rad = Two(body.place, F::kTilt), tilt_rate = Two(body.place, F::kTiltRate);
  motion.q_WB = body.R_WH * Eigen::AngleAxisd(tilt_rad.y(), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(tilt_rad.x(), Eigen::Vector3d::UnitX());
  motion.w_WB_B = {tilt_rate.x(), tilt_rate.y(), 0};
}

}  // namespace mascot
