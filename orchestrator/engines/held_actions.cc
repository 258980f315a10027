#include "orchestrator/engines/held_actions.h"

#include <fmt/format.h>

#include <stdexcept>

namespace mascot {

HeldActions::HeldActions(const Experiment& experiment) : actions_(experiment.agents.size()) { Adopt(experiment); }

void HeldActions::Adopt(const Experiment& now) {
  for (const AgentConfig& agent : now.agents) {
    std::vector<double>& action = actions_[static_cast<std::size_t>(agent.id - 1)];
    if (const std::size_t numbers = agent.law.params->action; action.size() != numbers) action.assign(numbers, 0);
  }
}

void HeldActions::Act(int id, std::span<const double> action) {
  if (const std::size_t expected = Of(id).size(); action.size() != expected)
    throw std::invalid_argument(
        fmt::format("agent {}: expected an action of {} numbers, got {}", id, expected, action.size()));
  actions_[static_cast<std::size_t>(id - 1)].assign(action.begin(), action.end());
}

}  // namespace mascot
