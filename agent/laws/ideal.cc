#include "agent/laws/ideal.h"

#include <cmath>

namespace mascot {

std::string WhyNotIdeal(const Experiment& experiment, Wanted wanted) {
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.traits().driven_by != wanted || agent.traits().rolls)
      return "the closed form is of " + std::string(wanted == Wanted::kVelocity ? "single" : "double") + " integrators";
    if (agent.start_s > 0 || std::isfinite(agent.stop_s)) return "agents come or go";
  }
  if (!experiment.schedule.IsConstant()) return "the graph changes";
  if (!experiment.links.ArePerfect(experiment.graph)) return "samples are lost or late";
  if (!experiment.sensors.own.IsNone() || !experiment.sensors.heard.IsNone() || experiment.sensors.own_delay_s > 0)
    return "what agents measure is noisy or late";
  return "";
}

std::string WhyNotIdealUndirected(const Experiment& experiment) {
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return why;
  if (!experiment.graph.IsSymmetric()) return "the closed forms are of undirected graphs";
  if (experiment.size() > kMostModes) return "the modes of so many agents are not computed";
  return experiment.graph.Roots().empty() ? "the graph is not connected" : "";
}

}  // namespace mascot
