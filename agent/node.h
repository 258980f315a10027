#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "agent/agent.h"
#include "idl/lifecycle.h"

namespace mascot {

/// One agent on the wire. It has readers on its own state and on the states and messages of those that the graph may
/// let it hear, and on no others. It decides and commands in the thread that received the last sample of a tick.
class Node {
 public:
  Node(Domain& domain, Lifecycle& lifecycle, Experiment& experiment, int id);

  /// Waits until every endpoint is matched, says READY, then answers ticks until it is ended (by Ended or a
  /// failure, which are thrown).
  [[noreturn]] void Run();

 private:
  /// What has come of one agent.
  struct Source {
    /// A message and the tick whose answer it came with.
    struct Message {
      std::int64_t tick = -1;
      std::vector<double> data;
    };
    std::int64_t tick = -1;  ///< of `motion`
    Motion motion;
    bool sends_messages = false;
    /// The last two, by tick modulo 2: a neighbour may be one answer ahead of us.
    std::array<Message, 2> messages;
  };

  bool Matched() const;
  void Listen(Domain& domain, std::size_t source, int id);
  void OnState(std::size_t source, const mascot_msgs::msg::AgentState& state);
  void OnMessage(std::size_t source, const mascot_msgs::msg::AgentMessage& message);
  // Below with mutex_ held.
  void AnswerIfComplete();
  void Answer(std::int64_t tick);
  /// Everything that may be heard at `tick` of `source` has come.
  bool IsComplete(const Source& source, std::int64_t tick) const;
  /// The last message that `source` sent before `tick`.
  std::span<const double> MessageBefore(const Source& source, std::int64_t tick) const;

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  const int id_;
  const bool realtime_;

  std::mutex mutex_;  // guards all below but the endpoints: different readers may be served at once
  Agent agent_;
  std::vector<Source> sources_;  // this agent, then those in the order of graph.HeardBy(id)
  std::vector<Sample> samples_;  // of the latter
  std::int64_t answered_ = -1;
  std::atomic<bool> flies_ = false;  // has answered a tick
  mascot_msgs::msg::AgentCommand command_;
  mascot_msgs::msg::AgentMessage message_;

  Writer<CommandType> commands_;
  std::optional<Writer<MessageType>> messages_;
  int hearers_ = 0;  // agents that may hear this one
  std::vector<std::unique_ptr<Reader<StateType>>> state_readers_;
  std::vector<std::unique_ptr<Reader<MessageType>>> message_readers_;
};

}  // namespace mascot
