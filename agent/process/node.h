#pragma once

#include <map>
#include <memory>
#include <vector>

#include "agent/process/agent_runner.h"
#include "bus/lifecycle.h"
#include "experiment/live_experiment.h"
#include "experiment/processes.h"

namespace mascot {

/// The DDS side of the agents in one process. Its readers, one for each topic, are on the states of these agents and on
/// the states and messages of the agents that the graph may let them hear, and on nothing else. (With network.delivery
/// = "bundled", bundles take the place of states.)
class Node {
 public:
  Node(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, AgentRange agents);

  /// Waits until every endpoint is matched, publishes READY, then answers ticks until Lifecycle::Wait() throws (Ended,
  /// or a failure).
  [[noreturn]] void Run();

 private:
  /// A runner that needs a sample, and the sender's index among the sources of that runner.
  struct Listener {
    AgentRunner* runner;
    std::size_t source;
  };

  bool Matched() const;
  void ListenToStates(Domain& domain);
  void ListenToBundles(Domain& domain);
  void ListenToMessages(Domain& domain);
  void ListenToEvents(Domain& domain);
  /// For each agent, by id, the runners that listen to it. With `own`, an agent's runner listens to the agent itself,
  /// too.
  std::map<int, std::vector<Listener>> Listeners(bool own) const;

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  std::vector<std::unique_ptr<AgentRunner>> runners_;
  LiveExperiment live_;                               // used by the reader of events alone
  std::vector<std::unique_ptr<ReaderBase>> readers_;  // last, so destroyed first: they call the members above
};

}  // namespace mascot
