#pragma once

#include <cstdint>
#include <vector>

#include "base/motion.h"
#include "experiment/events.h"

namespace mascot {

/// The serialized samples of one tick, agents by id - 1. Empty bytes: not sent, by an agent that is lost or, in real
/// time, has missed the tick.
struct Row {
  using Bytes = std::vector<std::uint8_t>;
  std::int64_t tick = -1;
  Bytes clock;
  std::vector<Bytes> states;
  std::vector<Bytes> commands;
  std::vector<Bytes> messages;  ///< empty for agents that send none
  std::vector<Bytes> actions;   ///< empty for agents that take none
  std::vector<Bytes> events;    ///< the events that take effect at this tick, in order

  explicit Row(int agents = 0)
      : states(static_cast<std::size_t>(agents)),
        commands(static_cast<std::size_t>(agents)),
        messages(static_cast<std::size_t>(agents)),
        actions(static_cast<std::size_t>(agents)) {}
};

/// The decoded samples of one tick, by id - 1.
struct DecodedRow {
  /// An event that takes effect at this tick.
  struct RowEvent {
    int number = 0;  ///< from 1 on, over the whole run
    Event event = {};
  };

  explicit DecodedRow(int agents)
      : motions(static_cast<std::size_t>(agents)),
        commands(motions.size()),
        has_answered(motions.size(), true),
        messages(motions.size()),
        actions(motions.size()) {}

  std::vector<Motion> motions;
  std::vector<Command> commands;              ///< a missing command keeps the value of the previous row (zero at first)
  std::vector<char> has_answered;             ///< whether the row has the agent's command
  std::vector<std::vector<double>> messages;  ///< empty: none was sent
  std::vector<std::vector<double>> actions;   ///< empty: the agent takes none, or has not answered
  std::vector<RowEvent> events;               ///< in order
  int events_so_far = 0;                      ///< number of the last event up to this tick; 0: there was no event
};

}  // namespace mascot
