#pragma once

#include <array>
#include <cstdint>

namespace mascot {

/// How a run in real time kept to its times.
struct Pacing {
  /// Median, 99th percentile, largest.
  using Spread = std::array<double, 3>;
  std::uint64_t misses = 0;     ///< commands that came too late for their tick
  Spread tick_lateness_s = {};  ///< from when a tick was due until its states were out
  Spread command_age_s = {};    ///< how old the states were that the commands in use answered; 0: this tick's
};

}  // namespace mascot
