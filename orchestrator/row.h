#pragma once

#include <cstdint>
#include <vector>

namespace mascot {

/// Everything that was on the wire about one tick, as bytes (idl/wire.h). By id - 1; empty: was not sent
/// (only in real time, where an agent may miss a tick).
struct Row {
  using Bytes = std::vector<std::uint8_t>;
  std::int64_t tick = -1;
  Bytes clock;
  std::vector<Bytes> states;
  std::vector<Bytes> commands;

  explicit Row(int agents = 0) : states(static_cast<std::size_t>(agents)), commands(static_cast<std::size_t>(agents)) {}
};

}  // namespace mascot
