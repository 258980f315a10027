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
      agent.id, airframe.MostThrust(), 100 * Airframe::kMostThrustShare, weight_n);
}

std::string ClimbsAway(const AgentConfig& agent, double weight_n) {
  const Airframe& airframe = agent.airframe;
  return fmt::format(
      "agents.airframe: agent {} climbs away: its rotors are driven to {:.4g} N at least ({:g} % of max_thrust_n), its "
      "weight is {:.4g} N (mass_kg, physics.gravity_m_per_s2)",
      agent.id, airframe.LeastThrust(), 100 * Airframe::kLeastThrustShare, weight_n);
}

}  // namespace

double LeanLimit(const AgentConfig& quadrotor, double gravity_m_per_s2) {
  const Airframe& airframe = quadrotor.airframe;
  const double up = std::max(gravity_m_per_s2, airframe.LeastThrust() / airframe.mass_kg);
  const double tilt_rad = airframe.tilt_limit_rad;
  return up * (quadrotor.control.inversion == Inversion::kExact ? std::tan(tilt_rad) : tilt_rad);
}

std::vector<std::string> LiftWarnings(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents) {
    if (!agent.traits().has_airframe) continue;
    const double weight_n = agent.airframe.mass_kg * experiment.physics.gravity_m_per_s2;
    if (weight_n > agent.airframe.MostThrust()) return {CannotLift(agent, weight_n)};
    if (weight_n < agent.airframe.LeastThrust()) return {ClimbsAway(agent, weight_n)};
  }
  return {};
}

}  // namespace mascot
