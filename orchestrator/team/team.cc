#include "orchestrator/team/team.h"

namespace mascot {

Team::Team(const Experiment& experiment) : exchange_(experiment) {
  for (const AgentConfig& config : experiment.agents) agents_.push_back(std::make_unique<Agent>(experiment, config.id));
}

Command Team::Decide(int id, std::int64_t tick, std::span<const Motion> motions) {
  const auto i = static_cast<std::size_t>(id - 1);
  Command command = agents_[i]->Decide(tick, motions[i], exchange_.SamplesFor(id, motions));
  exchange_.Send(id, agents_[i]->message());
  return command;
}

Command Team::Want(int id, std::int64_t tick, std::span<const Motion> motions) {
  const auto i = static_cast<std::size_t>(id - 1);
  Command command = agents_[i]->Want(tick, motions[i], exchange_.SamplesFor(id, motions));
  exchange_.Send(id, agents_[i]->message());
  return command;
}

}  // namespace mascot
