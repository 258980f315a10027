#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/agent_range.h"
#include "bus/bundle.h"
#include "experiment/experiment.h"

namespace mascot {

/// The samples that go to one process of agents, a tick each, with network.delivery = "bundled": states of the agents
/// of the process and of those that they may ever hear, and messages of the latter. Of no other agent is anything in
/// it. Keeps its memory from sample to sample.
class AgentsBundle {
 public:
  AgentsBundle(const Experiment& experiment, AgentRange agents);

  AgentRange agents() const { return agents_; }
  /// Ids of the agents whose states are in it, in their order: SourcesOf().
  const std::vector<int>& sources() const { return sources_; }
  /// Ids of those whose messages are in it, if there are any.
  const std::vector<int>& heard() const { return heard_; }

  /// Makes the sample of `tick`. `state_of(id)` is the body of an agent's state (std::span), `messages_of(id)` are the
  /// bodies of messages (const SampleBodies&): in lockstep at most one, sent with the answer to the tick before.
  template <class StateOf, class MessagesOf>
  void Make(std::int64_t tick, const StateOf& state_of, const MessagesOf& messages_of) {
    sample_.Begin(tick);
    sample_.BeginSection(static_cast<std::uint32_t>(agents_.size()));
    for (const int id : sources_) sample_.Add(state_of(id));
    sample_.BeginSection();
    for (const int id : heard_) sample_.Add(messages_of(id));
  }
  /// The newest sample.
  std::vector<std::uint8_t>& bytes() { return sample_.bytes(); }

 private:
  const AgentRange agents_;
  const std::vector<int> sources_, heard_;
  BundleWriter sample_;
};

}  // namespace mascot
