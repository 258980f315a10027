#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "agent/agent.h"
#include "idl/lifecycle.h"

namespace mascot {

/// One agent on the wire. It has readers on its own state and on those of the agents it hears by the graph,
/// and on no others. It decides and commands in the thread that received the last state of a tick.
class Node {
 public:
  Node(Domain& domain, Lifecycle& lifecycle, Experiment& experiment, int id);

  /// Waits until every endpoint is matched, says READY, then answers ticks until it is ended (by Ended or a
  /// failure, which are thrown).
  [[noreturn]] void Run();

 private:
  /// The newest sample of one agent.
  struct Latest {
    std::int64_t tick = -1;
    Motion motion;
  };

  bool Matched() const;
  void Hear(std::size_t source, const mascot_msgs::msg::AgentState& state);
  void Answer(std::int64_t tick);

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  const int id_;

  std::mutex mutex_;  // guards all below but the endpoints: different readers may be served at once
  Agent agent_;
  Latest self_;
  std::vector<Latest> neighbours_;  // in the order of graph.HeardBy(id)
  std::vector<Heard> heard_;        // the same, as the law sees them
  std::int64_t answered_ = -1;
  std::atomic<bool> flies_ = false;  // has answered a tick
  mascot_msgs::msg::AgentCommand command_;

  Writer<CommandType> commands_;
  std::vector<std::unique_ptr<Reader<StateType>>> states_;  // own first, then the neighbours'
};

}  // namespace mascot
