#include "orchestrator/theory/step_length.h"

#include <fmt/format.h>

#include <algorithm>

namespace mascot {

std::vector<std::string> StepLengthWarnings(const Experiment& experiment, double driven_m_per_s) {
  if (!experiment.physics.ground && !experiment.physics.collisions) return {};
  for (const AgentConfig& agent : experiment.agents) {
    const bool driven = agent.traits().driven_by == Wanted::kVelocity;
    const double speed = std::max(agent.v_W.norm(), driven ? driven_m_per_s : 0.0);
    const double step_m = speed / experiment.physics.rate_hz, size_m = agent.size_m().minCoeff();
    if (step_m <= size_m) continue;
    return {
        fmt::format("physics.rate_hz: agent {} goes {:.3g} m in a step of the physics, at {:.4g} m/s, and is {:.3g} m "
                    "thick: it may pass through what is in its way; above {:.0f} Hz it does not",
                    agent.id, step_m, speed, size_m, speed / size_m)};
  }
  return {};
}

}  // namespace mascot
