#pragma once

#include <span>
#include <vector>

#include "agent/link.h"
#include "experiment/experiment.h"

namespace mascot {

/// Exchange of samples between all agents in one process: gives each agent the states and messages of its neighbours in
/// experiment.graph.
class Exchange {
 public:
  explicit Exchange(const Experiment& experiment)
      : experiment_(experiment), messages_(experiment.agents.size()), next_messages_(experiment.agents.size()) {}

  // Within a tick, threads may call these two for agents of their own.

  /// The samples of the neighbours of agent `id` at this tick, with their motions (`motions` has those of all agents,
  /// by id - 1) and their messages of the previous tick. `samples` holds them. Valid until the tick ends.
  std::span<const Sample> SamplesFor(int id, std::span<const Motion> motions, std::vector<Sample>& samples) const {
    samples.clear();
    for (const Graph::Neighbour& neighbour : experiment_.graph.HeardBy(id)) {
      const auto i = static_cast<std::size_t>(neighbour.id - 1);
      samples.push_back({&motions[i], messages_[i]});
    }
    return samples;
  }
  /// Sends `message` from agent `id` at this tick. Its neighbours get it at the next tick.
  void Send(int id, std::span<const double> message) {
    next_messages_[static_cast<std::size_t>(id - 1)].assign(message.begin(), message.end());
  }
  void EndTick() { messages_.swap(next_messages_); }
  /// After EndTick(): the message that agent `id` has sent at the tick that ended is not sent.
  void TakeBack(int id) { messages_[static_cast<std::size_t>(id - 1)].clear(); }

 private:
  const Experiment& experiment_;
  std::vector<std::vector<double>> messages_, next_messages_;  // by id - 1
};

}  // namespace mascot
