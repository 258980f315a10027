#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "agent/neighbours.h"
#include "orchestrator/team/hearing.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// What happened on one directed edge in a run.
struct EdgeTraffic {
  int hearer = 0;
  int heard = 0;
  EdgeCount count;
  bool sends_messages = false;  ///< agent `heard` sends a message with each state
};

/// Counts the samples sent, lost and late on each edge in a run. A link depends only on the seed, the edge,
/// the tick and the agents' positions; the counts are therefore recomputed here from the rows, not reported by the
/// agents.
class LinkMeter {
 public:
  explicit LinkMeter(const Experiment& experiment);
  /// Call it when events have changed the experiment: from the next row on, the experiment is `now`.
  void Adopt(const std::shared_ptr<const Experiment>& now);
  /// Adds the next tick.
  void Add(std::int64_t tick, const DecodedRow& row);
  /// True as long as every sample of every edge has arrived at once: then EdgesNow() depends on no row.
  bool plain() const { return !hearing_; }
  /// One entry per edge, in increasing order of hearer, then of heard.
  std::vector<EdgeTraffic> Result() const;
  /// What became of each edge at the newest tick, in the same order. Replaces `edges`, which keeps its capacity.
  void EdgesNow(std::vector<EdgeNow>& edges) const;
  /// How many samples each edge has lost so far, in the same order; nothing as long as plain(). Replaces `lost`, which
  /// keeps its capacity.
  void LossesSoFar(std::vector<std::uint64_t>& lost) const;

 private:
  void CountSamples();

  const Experiment& experiment_;
  std::int64_t plain_rows_ = 0;
  std::vector<std::uint64_t> said_, sent_numbers_;  // if plain(), by id - 1: numbers in the last message; in all sent
  std::optional<Hearing> hearing_;                  // absent as long as plain(): rows need only be counted
};

}  // namespace mascot
