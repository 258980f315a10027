#pragma once

#include <cmath>
#include <cstdint>

namespace mascot {

/// If something happens again within this simulated time, it counts as one episode.
inline constexpr double kEpisodeGap_s = 0.5;

inline std::int64_t EpisodeGapTicks(double rate_hz) { return std::llround(kEpisodeGap_s * rate_hz); }

/// Ticks at which something happened, with gaps of at most kEpisodeGap_s.
struct Episode {
  std::int64_t from = 0, to = 0;  ///< the first and the last of these ticks
  std::int64_t count = 0;         ///< how many ticks, or how often it happened; 0: not yet

  /// Whether something that happens at `tick` begins another episode. `gap_ticks`: EpisodeGapTicks().
  bool IsOver(std::int64_t tick, std::int64_t gap_ticks) const { return count > 0 && tick - to > gap_ticks; }
  void Add(std::int64_t tick, std::int64_t times = 1) {
    if (count == 0) from = tick;
    to = tick;
    count += times;
  }
};

}  // namespace mascot
