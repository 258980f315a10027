#pragma once

#include <memory>
#include <span>
#include <vector>

#include "agent/agent.h"
#include "experiment/experiment.h"

namespace mascot {

/// All agents of an experiment in one process: brings to each what those sent that the graph may let it hear.
class Team {
 public:
  explicit Team(Experiment& experiment);

  Agent& agent(int id) { return *agents_[static_cast<std::size_t>(id - 1)]; }
  /// What `id` may hear at this tick: where they are by `motions` (by id - 1), and their last messages.
  std::span<const Sample> SamplesFor(int id, std::span<const Motion> motions);
  /// What agent `id` said at this tick; heard from the next one on.
  void KeepMessage(int id);
  /// The tick is over.
  void EndTick() { messages_.swap(next_messages_); }
  /// What agent `id` said at the tick before this one.
  const std::vector<double>& message(int id) const { return messages_[static_cast<std::size_t>(id - 1)]; }

 private:
  const Experiment& experiment_;
  std::vector<std::unique_ptr<Agent>> agents_;
  std::vector<std::vector<double>> messages_, next_messages_;  // by id - 1
  std::vector<Sample> samples_;
};

}  // namespace mascot
