#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/episode.h"

namespace mascot {

/// The ticks that ended before the agent's command had arrived.
struct LateCommands {
  int agent = 0;
  Episode ticks;
};

/// A run reports this many of them one by one, and only counts further ones.
inline constexpr std::size_t kMaxLatesTold = 256;

/// Timing statistics of a run in real time.
struct Pacing {
  /// Median, 99th percentile, largest. Those of times are within 0.6 %; the largest is exact.
  using Spread = std::array<double, 3>;
  std::uint64_t misses = 0;             ///< number of commands that were missing when their tick ended
  std::vector<LateCommands> late = {};  ///< the first kMaxLatesTold of them
  Spread tick_lateness_s = {};          ///< time from when a tick was due until its states were sent
  Spread command_age_s = {};  ///< age of the states that the applied commands answered; 0: those of the same tick
};

}  // namespace mascot
