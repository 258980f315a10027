#pragma once

#include <cmath>
#include <cstdint>

namespace mascot {

/// What comes again within so much simulated time goes on, and is told as one.
inline constexpr double kEpisodeGap_s = 0.5;

inline std::int64_t EpisodeGapTicks(double rate_hz) { return std::llround(kEpisodeGap_s * rate_hz); }

/// Ticks at which something was so, with gaps of at most kEpisodeGap_s.
struct Episode {
  std::int64_t from = 0, to = 0;  ///< the first and the last of them
  std::int64_t count = 0;         ///< how many, or how often; 0: none yet

  /// Whether what happens at `tick` begins another episode.
  bool IsOver(std::int64_t tick, std::int64_t gap_ticks) const { return count > 0 && tick - to > gap_ticks; }
  void Add(std::int64_t tick, std::int64_t times = 1) {
    if (count == 0) from = tick;
    to = tick;
    count += times;
  }
};

}  // namespace mascot
