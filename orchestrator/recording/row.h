#pragma once

#include <cstdint>
#include <vector>

#include "idl/topics.h"

namespace mascot {

/// Everything that was on the wire about one tick, as bytes (bus/wire.h). By id - 1; empty: was not sent
/// (only in real time, where an agent may miss a tick).
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

  /// The place of a per-tick topic's sample.
  Bytes& Of(const Topic& topic) {
    const auto agent = static_cast<std::size_t>(topic.agent - 1);
    return topic.kind == TopicKind::kState     ? states[agent]
           : topic.kind == TopicKind::kCommand ? commands[agent]
           : topic.kind == TopicKind::kMessage ? messages[agent]
                                               : clock;
  }
};

}  // namespace mascot
