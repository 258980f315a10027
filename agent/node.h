#pragma once

#include <map>
#include <memory>
#include <vector>

#include "agent/seat.h"
#include "bus/lifecycle.h"
#include "experiment/processes.h"

namespace mascot {

/// The agents of one process on the wire. It has readers on their own states and on the states and messages of the
/// agents that the graph may let them hear, one for each topic, and on no others.
class Node {
 public:
  Node(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, AgentRange agents);

  /// Waits until every endpoint is matched, says READY, then answers ticks until it is ended (by Ended or a
  /// failure, which are thrown).
  [[noreturn]] void Run();

 private:
  /// A seat that a sample is for, and its sender's place among what that seat hears.
  struct Listener {
    Seat* seat;
    std::size_t source;
  };

  bool Matched() const;
  void ListenToStates(Domain& domain);
  void ListenToBundles(Domain& domain);
  void ListenToMessages(Domain& domain);
  /// The seats that listen to each agent, by its id. `own`: agents listen to themselves, too.
  std::map<int, std::vector<Listener>> Listeners(bool own) const;

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  std::vector<std::unique_ptr<Seat>> seats_;
  std::vector<std::unique_ptr<ReaderBase>> readers_;  // last: readers call what is above
};

}  // namespace mascot
