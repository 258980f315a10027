#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace mascot {

/// Says at each tick what agents do whose laws take actions (LawParams::action).
class ActionSource {
 public:
  virtual ~ActionSource() = default;
  /// The actions of `tick`, by id - 1; empty: the agent gets none, so that the action before holds. Ticks increase from
  /// call to call. Valid until the next call. Throws std::runtime_error if there are none for this tick.
  virtual std::span<const std::vector<double>> At(std::int64_t tick) = 0;
};

}  // namespace mascot
