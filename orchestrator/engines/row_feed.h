#pragma once

#include <cstdint>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/recording/row_codec.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Hands the rows of a run to its sinks, in their order, each row decoded once and encoded at most once.
class RowFeed {
 public:
  /// The sinks outlive this.
  RowFeed(const Experiment& experiment, std::vector<RowSink*> sinks);

  /// The next tick, as it was on the wire. Throws std::runtime_error for bytes that are no samples, and what a sink
  /// throws.
  void Add(const Row& bytes);
  /// The next tick, as it was flown in one process.
  void Add(std::int64_t tick, const DecodedRow& decoded);

 private:
  void HandOut(const FlownRow& row) const;

  std::vector<RowSink*> sinks_;
  DecodedRow decoded_;  // of the newest row from the wire: a command that is missing in the next is held
  RowEncoder encoder_;
};

}  // namespace mascot
