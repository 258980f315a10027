#pragma once

#include <cstdint>
#include <vector>

#include "experiment/motion.h"

namespace mascot {

/// Everything that was on the wire about one tick, as bytes. By id - 1; empty: was not sent (only in real time, where
/// an agent may miss a tick).
struct Row {
  using Bytes = std::vector<std::uint8_t>;
  std::int64_t tick = -1;
  Bytes clock;
  std::vector<Bytes> states;
  std::vector<Bytes> commands;
  std::vector<Bytes> messages;  ///< only of agents that send any

  explicit Row(int agents = 0)
      : states(static_cast<std::size_t>(agents)),
        commands(static_cast<std::size_t>(agents)),
        messages(static_cast<std::size_t>(agents)) {}
};

/// A row's samples in our own types, by id - 1.
struct DecodedRow {
  explicit DecodedRow(int agents)
      : motions(static_cast<std::size_t>(agents)), commands(motions.size()), messages(motions.size()) {}

  std::vector<Motion> motions;
  std::vector<Command> commands;              ///< one that was not sent is that of the row before (zero at first)
  std::vector<std::vector<double>> messages;  ///< empty: nothing was sent
};

}  // namespace mascot
