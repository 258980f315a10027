#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include "agent/agent.h"
#include "agent/low_level.h"
#include "agent/process/tick_inbox.h"
#include "bus/bus.h"
#include "bus/wire.h"

namespace mascot {

/// The DDS side of one agent: it collects the agent's samples (TickInbox), and answers each complete tick with a
/// command and perhaps a message. The thread that receives the last sample of a tick decides and writes. Several
/// runners may share a process and its readers (AgentsOnTopics).
class AgentRunner {
 public:
  /// `on_first_answer` is called once, in the thread that answers first.
  AgentRunner(Domain& domain, const Experiment& experiment, int id, std::function<void()> on_first_answer);

  int id() const { return id_; }
  /// As Agent::AwaitLaw(). To be called before samples arrive.
  void AwaitLaw() { agent_.AwaitLaw(); }
  /// True when all readers of what this agent writes are matched.
  bool Matched() const;
  bool has_answered() const { return has_answered_; }

  // Samples that arrive, as TickInbox takes them. `source`: 0 is the agent itself, then the agents that it may hear, in
  // the order of graph.HeardBy(id). Called by the readers of AgentsOnTopics, in
  // their threads.
  void OnState(std::size_t source, std::int64_t tick, const Motion& motion, int events);
  void OnMessage(std::size_t source, std::int64_t tick, std::span<const double> data);
  void OnAction(std::int64_t tick, std::span<const double> action);
  /// `now` is the experiment after the event.
  void OnEvent(int number, const Event& event, const std::shared_ptr<const Experiment>& now);

 private:
  /// Lets the agent adopt what the first `events` events have made of the experiment.
  void TakeEvents(int events);
  /// Runs the agent on a complete tick and writes its answer. Called with mutex_ held.
  void Answer(const TickInbox::CompleteTick& complete);

  const Experiment& experiment_;
  const int id_;
  const std::function<void()> on_first_answer_;

  std::mutex mutex_;  // guards what is below except the endpoints: readers may call in different threads
  Agent agent_;
  LowLevel low_level_;
  TickInbox inbox_;
  std::deque<std::pair<int, std::shared_ptr<const Experiment>>> events_;  // not yet adopted, by number
  std::atomic<bool> has_answered_ = false;
  mascot_msgs::msg::AgentCommand command_;
  mascot_msgs::msg::AgentMessage message_;

  Writer<CommandType> commands_;
  std::optional<Writer<MessageType>> messages_;
  int message_readers_ = 0;  // number of readers that messages_ must match
};

}  // namespace mascot
