#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <span>

#include "agent/process/agents_on_wire.h"
#include "bus/lifecycle.h"
#include "experiment/live_experiment.h"

namespace mascot {

/// The DDS side of the agents in one process. Its readers are on what the graph may let these agents hear, on events,
/// and on nothing else.
class Node {
 public:
  /// `history`: the events before the first tick that these agents answer.
  Node(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, AgentRange agents,
       std::span<const mascot_msgs::msg::Event> history);

  /// Waits until every endpoint is matched, publishes READY, then answers ticks until Wait() throws (Ended,
  /// KilledByEvent, or a failure).
  [[noreturn]] void Run();

 private:
  bool Matched() const { return agents_->Matched() && events_.matched() >= 1; }
  void OnEvent(const mascot_msgs::msg::Event& event);
  /// Whether events have killed all agents of this process.
  bool AreKilled(const Experiment& now) const;
  /// As Lifecycle::Wait(). Throws KilledByEvent, too.
  void Wait(std::chrono::nanoseconds timeout);

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  const AgentRange ids_;
  LiveExperiment live_;  // used by the reader of events alone
  std::atomic<bool> is_killed_ = false;
  std::unique_ptr<AgentsOnWire> agents_;
  Reader<EventType> events_;  // last, so destroyed first: it calls the members above
};

}  // namespace mascot
