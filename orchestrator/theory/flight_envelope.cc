#include "orchestrator/theory/flight_envelope.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

std::string CannotLift(const AgentConfig& agent, double weight_n) {
  const Airframe& airframe = agent.airframe;
  return fmt::format(
      "agents.airframe: agent {} cannot lift itself: its rotors are driven to {:.4g} N at most ({:g} % of "
      "max_thrust_n), its weight is {:.4g} N (mass_kg, physics.gravity_m_per_s2)",
      agent.id, airframe.MaxCommandedThrust(), 100 * Airframe::kMaxCommandedShare, weight_n);
}

std::string ClimbsAway(const AgentConfig& agent, double weight_n) {
  const Airframe& airframe = agent.airframe;
  return fmt::format(
      "agents.airframe: agent {} climbs away: its rotors are driven to {:.4g} N at least ({:g} % of max_thrust_n), its "
      "weight is {:.4g} N (mass_kg, physics.gravity_m_per_s2)",
      agent.id, airframe.MinCommandedThrust(), 100 * Airframe::kMinCommandedShare, weight_n);
}

std::string FallsWithout(const RotorFailure& failure, double left_n, double needed_n) {
  return fmt::format(
      "physics.rotor_failures: agent {} will fall: from {:g} s on, rotor {} gives {:.4g} N at most, and {:.4g} N, a "
      "quarter of its weight, is needed to hover level",
      failure.agent, failure.at_s, failure.rotor, left_n, needed_n);
}

/// What the thrust gives at a constant height (m/s^2), or the least thrust where that is more.
double UpAccel(const Airframe& airframe, double gravity_m_per_s2) {
  return std::max(gravity_m_per_s2, airframe.MinCommandedThrust() / airframe.mass_kg);
}

}  // namespace

double LeanLimit(const AgentConfig& quadrotor, double gravity_m_per_s2) {
  const double tilt_rad = quadrotor.airframe.tilt_limit_rad;
  return UpAccel(quadrotor.airframe, gravity_m_per_s2) *
         (quadrotor.control.inversion == Inversion::kExact ? std::tan(tilt_rad) : tilt_rad);
}

// A turn by `angle` to a target is late by the area below the error divided by the angle, which is the larger of
//   kd / kp                                             PD law, damped well
//   angle / (2 turn_rate) + turn_rate (kd / kp)^2 / (2 angle)    the same, above the largest turning rate
//   sqrt(angle / A)                                     half of the time for speeding up and braking with A
double AccelerationLag(const Experiment& experiment, const AgentConfig& quadrotor, double a_m_per_s2) {
  const Airframe& body = quadrotor.airframe;
  const double gravity = experiment.physics.gravity_m_per_s2;
  const double up = UpAccel(body, gravity);
  const double angle_rad = 2 * a_m_per_s2 / up;
  const double pd_s = body.attitude.kd / body.attitude.kp;
  const double rate = Airframe::kMaxTurnRate;
  const double slew_s = angle_rad > rate * pd_s ? angle_rad / (2 * rate) + rate * pd_s * pd_s / (2 * angle_rad) : pd_s;
  const double hover_n = body.mass_kg * up;
  const double torque_nm = body.arm_m / 2 * std::min(hover_n, body.max_thrust_n - hover_n);
  const double turn_accel = torque_nm / body.inertia_kg_m2.head<2>().maxCoeff();
  const double turn_s = std::max(slew_s, std::sqrt(angle_rad / turn_accel));
  return turn_s + body.rotor_time_constant_s + experiment.period_s();
}

std::vector<std::string> LiftWarnings(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents) {
    if (!agent.traits().has_airframe) continue;
    const double weight_n = agent.airframe.mass_kg * experiment.physics.gravity_m_per_s2;
    if (weight_n > agent.airframe.MaxCommandedThrust()) return {CannotLift(agent, weight_n)};
    if (weight_n < agent.airframe.MinCommandedThrust()) return {ClimbsAway(agent, weight_n)};
  }
  return {};
}

std::vector<std::string> RotorFailureWarnings(const Experiment& experiment) {
  for (const RotorFailure& failure : experiment.physics.rotor_failures) {
    const Airframe& airframe = experiment.agent(failure.agent).airframe;
    const double needed_n = airframe.mass_kg * experiment.physics.gravity_m_per_s2 / 4;
    const double left_n = failure.remaining * airframe.max_thrust_n / 4;
    if (left_n < needed_n && failure.at_s < experiment.run.duration_s) return {FallsWithout(failure, left_n, needed_n)};
  }
  return {};
}

}  // namespace mascot
