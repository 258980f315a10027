#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "agent/agent.h"
#include "bus/bus.h"
#include "bus/wire.h"

namespace mascot {

/// One agent's place on the wire: what has come for it, and what it answers. It decides and commands in the thread that
/// brings the last sample of a tick. Several may share a process (Node), whose readers they share.
class Seat {
 public:
  /// `on_first_answer` is called once, in the thread of that answer.
  Seat(Domain& domain, const Experiment& experiment, int id, std::function<void()> on_first_answer);

  int id() const { return id_; }
  /// Everybody who reads what this agent writes has been found.
  bool Matched() const;
  bool has_answered() const { return has_answered_; }

  // What comes. `source`: 0 is the agent itself, then those that it may hear, in the order of graph.HeardBy(id).
  void OnState(std::size_t source, std::int64_t tick, const Motion& motion);
  void OnMessage(std::size_t source, std::int64_t tick, std::span<const double> data);
  /// States of all sources, in order. Throws std::runtime_error if they are others.
  void OnBundle(const mascot_msgs::msg::AgentBundle& bundle);

 private:
  /// What has come of one agent.
  struct Source {
    /// A message and the tick whose answer it came with.
    struct Message {
      std::int64_t tick = -1;
      std::vector<double> data;
    };
    int id = 0;
    std::int64_t tick = -1;  ///< of `motion`
    Motion motion = {};
    bool sends_messages = false;
    /// The last two, by tick modulo 2: a neighbour may be one answer ahead of us.
    std::array<Message, 2> messages = {};
  };

  // Below with mutex_ held.
  void AnswerIfComplete();
  void Answer(std::int64_t tick);
  /// Everything that may be heard at `tick` of `source` has come.
  bool IsComplete(const Source& source, std::int64_t tick) const;
  /// The last message that `source` sent before `tick`.
  std::span<const double> MessageBefore(const Source& source, std::int64_t tick) const;

  const Experiment& experiment_;
  const int id_;
  const bool realtime_;
  const std::function<void()> on_first_answer_;

  std::mutex mutex_;  // guards all below but the endpoints: different readers may be served at once
  Agent agent_;
  std::vector<Source> sources_;
  std::vector<Sample> samples_;  // of those that it hears
  std::int64_t answered_ = -1;
  std::atomic<bool> has_answered_ = false;
  mascot_msgs::msg::AgentCommand command_;
  mascot_msgs::msg::AgentMessage message_;

  Writer<CommandType> commands_;
  std::optional<Writer<MessageType>> messages_;
  int message_readers_ = 0;  // that the last must find
};

}  // namespace mascot
