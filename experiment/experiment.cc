#include "experiment/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "experiment/toml/section.h"

namespace mascot {

std::int64_t Experiment::ticks() const { return std::llround(run.duration_s * control.rate_hz); }

bool TakesActions(const Experiment& experiment) {
  return std::ranges::any_of(experiment.agents, &AgentConfig::takes_actions);
}

void RefuseActions(const Experiment& experiment) {
  const auto taker = std::ranges::find_if(experiment.agents, &AgentConfig::takes_actions);
  if (taker == experiment.agents.end()) return;
  throw ConfigError(
      {fmt::format("law.name: expected laws that decide by themselves, got one of agent {} that takes "
                   "actions: a program that steps the run gives them, this command does not",
                   taker->id)});
}

std::string LossThatEndsTheRun(const Experiment& now) {
  if (now.run.on_agent_loss != OnAgentLoss::kAbort) return "";
  const auto lost = std::ranges::find_if(now.agents, [](const AgentConfig& agent) { return agent.faults.is_lost(); });
  if (lost == now.agents.end()) return "";
  return "agent " + std::to_string(lost->id) +
         " is lost: " + (lost->faults.hangs ? "it hangs" : "its process has died") + " (run.on_agent_loss = \"abort\")";
}

std::string WhatFollowsALoss(const Experiment& experiment) {
  const auto& run = experiment.run;
  const std::string key = "run.on_agent_loss = \"" + std::string(kOnAgentLoss.Name(run.on_agent_loss)) + "\": ";
  switch (run.on_agent_loss) {
    case OnAgentLoss::kHold:
      return key + "the actuators keep their last values";
    case OnAgentLoss::kDrop:
      return key + "the actuators go to zero";
    default:
      return key + "a fresh agent takes its place after " + ShortestFloat(run.restart_after_s) + " s";
  }
}

}  // namespace mascot
