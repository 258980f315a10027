#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "base/motion.h"
#include "base/random.h"
#include "experiment/faults.h"

namespace mascot {

/// What an agent measures of its own position and velocity while its sensor has a fault (FaultPart::kSensor). What it
/// measures of its attitude is right. Depends only on the seed, the agent, the ticks and what it would have measured.
class FaultySensor {
 public:
  /// `last`: what the agent measured at the tick before; nullopt: it is fresh.
  FaultySensor(const PartFault& fault, int rate_hz, std::uint64_t seed, const std::optional<Motion>& last);

  std::int64_t since() const { return fault_.since; }
  /// What it measures at `tick` (increasing) instead of `right`.
  Motion Measure(std::int64_t tick, const Motion& right);

 private:
  /// The reading that the fault makes of `right`.
  Motion ReadingAt(std::int64_t tick, const Motion& right);

  PartFault fault_;
  double rate_hz_;
  std::int64_t period_ticks_, delay_ticks_;
  Dice dice_;
  std::optional<Motion> last_;  // reading
  std::int64_t last_tick_ = 0;  // of last_, where dead reckoning starts
  std::deque<Motion> late_;     // right readings on their way
};

}  // namespace mascot
