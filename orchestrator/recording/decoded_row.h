#pragma once

#include <vector>

#include "experiment/motion.h"
#include "orchestrator/recording/row.h"

namespace mascot {

/// A row's samples in our own types, by id - 1.
struct DecodedRow {
  explicit DecodedRow(int agents)
      : motions(static_cast<std::size_t>(agents)), commands(motions.size()), messages(motions.size()) {}

  /// Decodes `row`. A command that was not sent is held: it stays that of the row before (zero at first). Throws
  /// std::runtime_error for bytes that are no such sample.
  void Take(const Row& row);

  std::vector<Motion> motions;
  std::vector<Command> commands;
  std::vector<std::vector<double>> messages;  ///< empty: nothing was sent
};

}  // namespace mascot
