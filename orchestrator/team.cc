#include "orchestrator/team.h"

namespace mascot {

Team::Team(Experiment& experiment)
    : experiment_(experiment),
      messages_(static_cast<std::size_t>(experiment.size())),
      next_messages_(static_cast<std::size_t>(experiment.size())) {
  for (const AgentConfig& config : experiment.agents) agents_.push_back(std::make_unique<Agent>(experiment, config.id));
}

std::span<const Sample> Team::SamplesFor(int id, std::span<const Motion> motions) {
  samples_.clear();
  for (const Graph::Neighbour& neighbour : experiment_.graph.HeardBy(id))
    samples_.push_back({&motions[static_cast<std::size_t>(neighbour.id - 1)], message(neighbour.id)});
  return samples_;
}

void Team::KeepMessage(int id) {
  const std::span<const double> said = agent(id).message();
  next_messages_[static_cast<std::size_t>(id - 1)].assign(said.begin(), said.end());
}

}  // namespace mascot
