#include "orchestrator/recording/recorded_actions.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "orchestrator/recording/row_codec.h"

namespace mascot {

RecordedActions::RecordedActions(const std::string& recording, const RecordingPlan& plan, const Experiment& experiment)
    : recording_(recording), rows_(recording, plan.agents, plan.rate_hz), actions_(experiment.agents.size()) {
  if (plan.ticks_per_row > 1)
    throw ConfigError(
        {fmt::format("{}: expected a recording of every tick, of agents that are told what to do, got one of every {} "
                     "ticks (record.rate_hz)",
                     recording, plan.ticks_per_row)});
  for (const AgentConfig& agent : experiment.agents)
    if (agent.takes_actions && std::ranges::find(plan.topics, Topic::Action(agent.id)) == plan.topics.end())
      throw ConfigError({fmt::format("{}: holds no {}, which says what its agent did: record.topics left it out",
                                     recording, Topic::Action(agent.id).Name())});
}

std::span<const std::vector<double>> RecordedActions::At(std::int64_t tick) {
  while (row_ == nullptr || row_->tick < tick)
    if (row_ = rows_.Next(); row_ == nullptr)
      throw std::runtime_error(fmt::format("{}: has no actions of tick {}", recording_, tick));
  for (std::size_t i = 0; i < actions_.size(); ++i) DecodeAction(*row_, static_cast<int>(i) + 1, actions_[i]);
  return actions_;
}

}  // namespace mascot
