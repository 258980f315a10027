#pragma once

#include <cstdint>
#include <vector>

#include "agent/neighbours.h"
#include "orchestrator/team/exchange.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// What happened on one directed edge in a run.
struct EdgeTraffic {
  int hearer = 0;
  int heard = 0;
  EdgeCount count;
  bool sends_messages = false;  ///< the one who is heard does: beside each state sent a message
};

/// Counts what links did with the samples of a run. What a link does depends on the seed, the edge, the tick and where
/// the agents were alone, so that it is known from the recorded rows, whichever process the hearer was in.
class LinkMeter {
 public:
  explicit LinkMeter(const Experiment& experiment);
  /// The next tick.
  void Add(std::int64_t tick, const DecodedRow& row);
  /// By hearer, then by heard, both increasing.
  std::vector<EdgeTraffic> Result() const;

 private:
  const Experiment& experiment_;
  bool plain_;  // every sample of every edge arrives: rows say it all
  std::int64_t rows_ = 0;
  std::vector<std::uint64_t> said_, sent_numbers_;  // plain, by id - 1: numbers in the last message, in those sent
  std::vector<Neighbours> neighbours_;              // else, by id - 1
  Exchange exchange_;
};

}  // namespace mascot
