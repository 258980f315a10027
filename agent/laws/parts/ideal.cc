#include "agent/laws/parts/ideal.h"

#include <algorithm>
#include <cmath>

namespace mascot {

namespace {

bool LagsOrRolls(const AgentConfig& agent) { return agent.traits().has_airframe || agent.traits().rolls; }

}  // namespace

std::string WhyNotIdeal(const Experiment& experiment, Wanted wanted) {
  if (std::ranges::any_of(experiment.agents, LagsOrRolls))
    return "the closed form is of " + std::string(wanted == Wanted::kVelocity ? "single" : "double") + " integrators";
  return WhyNotNearlyIdeal(experiment, wanted);
}

std::string WhyNotNearlyIdeal(const Experiment& experiment, Wanted wanted) {
  for (const AgentConfig& agent : experiment.agents)
    if (agent.traits().driven_by != wanted || agent.traits().rolls)
      return "the closed form is of " + std::string(wanted == Wanted::kVelocity ? "single" : "double") + " integrators";
  if (std::string why = WhyNotAllHeard(experiment); !why.empty()) return why;
  if (!experiment.sensors.own.IsNone() || !experiment.sensors.heard.IsNone() || experiment.sensors.own_delay_s > 0)
    return "what agents measure is noisy or late";
  return "";
}

std::string WhyNotAllHeard(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents)
    if (agent.lie) return "an agent lies";
  for (const AgentConfig& agent : experiment.agents)
    if (agent.start_s > 0 || std::isfinite(agent.stop_s)) return "agents come or go";
  if (!experiment.schedule.IsConstant()) return "the graph changes";
  return experiment.links.ArePerfect(experiment.graph) ? "" : "samples are lost or late";
}

std::string WhyNotUndirected(const Experiment& experiment) {
  if (!experiment.graph.IsSymmetric()) return "the closed forms are of undirected graphs";
  if (experiment.size() > kMaxModes) return "the modes of so many agents are not computed";
  return experiment.graph.Roots().empty() ? "the graph is not connected" : "";
}

std::string WhyNotIdealUndirected(const Experiment& experiment) {
  std::string why = WhyNotIdeal(experiment, Wanted::kVelocity);
  return why.empty() ? WhyNotUndirected(experiment) : why;
}

}  // namespace mascot
