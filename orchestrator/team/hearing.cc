#include "orchestrator/team/hearing.h"

namespace mascot {

Hearing::Hearing(const Experiment& experiment) : exchange_(experiment), heard_(experiment.agents.size()) {
  for (const AgentConfig& agent : experiment.agents) neighbours_.emplace_back(experiment, agent.id);
}

void Hearing::Adopt(const std::shared_ptr<const Experiment>& now) {
  for (Neighbours& neighbours : neighbours_) neighbours.Adopt(*now);
  now_ = now;
}

void Hearing::Hear(std::int64_t tick, std::span<const Motion> motions) {
  for (std::size_t i = 0; i < neighbours_.size(); ++i)
    heard_[i] = neighbours_[i].Hear(tick, motions[i], exchange_.SamplesFor(static_cast<int>(i) + 1, motions, samples_));
}

void Hearing::Send(std::span<const std::vector<double>> messages) {
  for (std::size_t i = 0; i < neighbours_.size(); ++i) exchange_.Send(static_cast<int>(i) + 1, messages[i]);
  exchange_.EndTick();
}

}  // namespace mascot
