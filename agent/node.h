#pragma once

#include <map>
#include <memory>
#include <vector>

#include "agent/seat.h"
#include "bus/lifecycle.h"
#include "experiment/processes.h"

namespace mascot {

/// The agents of one process on the wire. It has readers on their own states and on the states and messages of those
/// that the graph may let them hear, one for each topic, and on no others.
class Node {
 public:
  Node(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, AgentRange agents);

  /// Waits until every endpoint is matched, says READY, then answers ticks until it is ended (by Ended or a
  /// failure, which are thrown).
  [[noreturn]] void Run();

 private:
  /// Somebody in this process for whom a topic is.
  struct Ear {
    Seat* seat;
    std::size_t source;
  };

  bool Matched() const;
  void ListenToStates(Domain& domain);
  void ListenToBundles(Domain& domain);
  void ListenToMessages(Domain& domain);
  /// By the id of who is heard; `own`: themselves too.
  std::map<int, std::vector<Ear>> Ears(bool own) const;

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  std::vector<std::unique_ptr<Seat>> seats_;
  std::vector<std::unique_ptr<ReaderBase>> readers_;  // last: they call what is above
};

}  // namespace mascot
