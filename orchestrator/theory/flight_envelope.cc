#include "orchestrator/theory/flight_envelope.h"

#include <fmt/format.h>

#include <cmath>

namespace mascot {

double LeanLimit(const AgentConfig& quadrotor, double gravity_m_per_s2) {
  const double tilt_rad = quadrotor.airframe.tilt_limit_rad;
  return gravity_m_per_s2 * (quadrotor.control.inversion == Inversion::kExact ? std::tan(tilt_rad) : tilt_rad);
}

std::vector<std::string> LiftWarnings(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents) {
    const Airframe& airframe = agent.airframe;
    const double weight_n = airframe.mass_kg * experiment.physics.gravity_m_per_s2;
    if (!agent.traits().has_airframe || airframe.max_thrust_n > weight_n) continue;
    return {
        fmt::format("agents.airframe: agent {} cannot lift itself: its rotors give {:.4g} N at most (max_thrust_n), "
                    "its weight is {:.4g} N (mass_kg, physics.gravity_m_per_s2)",
                    agent.id, airframe.max_thrust_n, weight_n)};
  }
  return {};
}

}  // namespace mascot
