#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/episode.h"

namespace mascot {

/// Ticks at which an agent's command had not come when they ended.
struct LateCommands {
  int agent = 0;
  Episode ticks;
};

/// A run tells of so many of them; beyond, it counts them.
inline constexpr std::size_t kMostLatesTold = 256;

/// Timing statistics of a run in real time.
struct Pacing {
  /// Median, 99th percentile, largest.
  using Spread = std::array<double, 3>;
  std::uint64_t misses = 0;             ///< commands missing when their tick ended
  std::vector<LateCommands> late = {};  ///< the first kMostLatesTold of them
  Spread tick_lateness_s = {};          ///< from when a tick was due until its states were out
  Spread command_age_s = {};            ///< age of the states that the commands used answered; 0: this tick's
};

}  // namespace mascot
