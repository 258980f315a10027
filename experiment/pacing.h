#pragma once

#include <array>
#include <cstdint>

namespace mascot {

/// Timing statistics of a run in real time.
struct Pacing {
  /// Median, 99th percentile, largest.
  using Spread = std::array<double, 3>;
  std::uint64_t misses = 0;     ///< commands missing when their tick ended
  Spread tick_lateness_s = {};  ///< from when a tick was due until its states were out
  Spread command_age_s = {};    ///< age of the states that the commands used answered; 0: this tick's
};

}  // namespace mascot
