#include "experiment/experiment.h"

#include <algorithm>
#include <cmath>

namespace mascot {

std::int64_t Experiment::ticks() const { return std::llround(run.duration_s * control.rate_hz); }

std::string LossThatEndsTheRun(const Experiment& now) {
  if (now.run.on_agent_loss != OnAgentLoss::kAbort) return "";
  const auto lost = std::ranges::find_if(now.agents, [](const AgentConfig& agent) { return agent.faults.is_lost(); });
  if (lost == now.agents.end()) return "";
  return "agent " + std::to_string(lost->id) +
         " is lost: " + (lost->faults.hangs ? "it hangs" : "its process has died") + " (run.on_agent_loss = \"abort\")";
}

}  // namespace mascot
