#include "orchestrator/team/team.h"

namespace mascot {

Team::Team(const Experiment& experiment)
    : low_level_(experiment, {1, experiment.size()}), driven_(experiment.agents.size()), exchange_(experiment) {
  for (const AgentConfig& config : experiment.agents) agents_.push_back(std::make_unique<Agent>(experiment, config.id));
}

void Team::Decide(std::int64_t tick, std::span<const Motion> motions, std::span<Command> commands) {
  for (std::size_t i = 0; i < agents_.size(); ++i) {
    commands[i] = Want(agents_[i]->id(), tick, motions);
    driven_[i] = agents_[i]->Driven(commands[i]);
  }
  low_level_.Actuate(driven_, commands);
  EndTick();
}

Command Team::Want(int id, std::int64_t tick, std::span<const Motion> motions) {
  const auto i = static_cast<std::size_t>(id - 1);
  Command command = agents_[i]->Want(tick, motions[i], exchange_.SamplesFor(id, motions));
  exchange_.Send(id, agents_[i]->message());
  return command;
}

}  // namespace mascot
