#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "agent/agent.h"
#include "agent/tick_inbox.h"
#include "bus/bus.h"
#include "bus/wire.h"

namespace mascot {

/// One agent's place on the wire: what has come for it (TickInbox), and what it answers. It decides and commands in the
/// thread that brings the last sample of a tick. Several may share a process (Node), whose readers they share.
class Seat {
 public:
  /// `on_first_answer` is called once, in the thread of that answer.
  Seat(Domain& domain, const Experiment& experiment, int id, std::function<void()> on_first_answer);

  int id() const { return id_; }
  /// Everybody who reads what this agent writes has been found.
  bool Matched() const;
  bool has_answered() const { return has_answered_; }

  // What comes, as TickInbox takes it. `source`: 0 is the agent itself, then the agents that it may hear, in the order
  // of graph.HeardBy(id).
  void OnState(std::size_t source, std::int64_t tick, const Motion& motion);
  void OnMessage(std::size_t source, std::int64_t tick, std::span<const double> data);
  /// States of all sources, in order. Throws std::runtime_error if they are others.
  void OnBundle(const mascot_msgs::msg::AgentBundle& bundle);

 private:
  /// Decides and sends what the agent answers. Called with mutex_ held.
  void Answer(const TickInbox::CompleteTick& complete);

  const Experiment& experiment_;
  const int id_;
  const std::function<void()> on_first_answer_;

  std::mutex mutex_;  // guards all below but the endpoints: different readers may be served at once
  Agent agent_;
  TickInbox inbox_;
  std::vector<TickInbox::State> states_;  // what the last bundle held
  std::atomic<bool> has_answered_ = false;
  mascot_msgs::msg::AgentCommand command_;
  mascot_msgs::msg::AgentMessage message_;

  Writer<CommandType> commands_;
  std::optional<Writer<MessageType>> messages_;
  int message_readers_ = 0;  // how many messages_ must find
};

}  // namespace mascot
