#pragma once

#include <cstdint>

#include "orchestrator/team/row.h"

namespace mascot {

/// One tick of a run, as an engine hands it to its sinks.
class FlownRow {
 public:
  virtual ~FlownRow() = default;
  virtual std::int64_t tick() const = 0;
  virtual const DecodedRow& decoded() const = 0;
  /// The samples as they were on the wire; of a run in one process, as they would have been. Made when first asked for.
  virtual const Row& bytes() const = 0;
};

/// Takes every row of a run, in order of tick: the files of a run, meters, the progress line.
class RowSink {
 public:
  virtual ~RowSink() = default;
  /// The next row, valid during the call. What this throws fails the run.
  virtual void Add(const FlownRow& row) = 0;
};

}  // namespace mascot
