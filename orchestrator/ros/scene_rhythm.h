#pragma once

#include <cstdint>

#include "experiment/experiment.h"

namespace mascot {

/// When a recording has a message on /scene (record.ros_types): all markers at tick 0 and once a simulated second, the
/// edges alone up to 30 times a second, if there are few; at ticks that record.rate_hz gives a row.
class SceneRhythm {
 public:
  enum class Due { kNothing, kEdges, kAll };

  explicit SceneRhythm(const Experiment& experiment)
      : rate_hz_(experiment.control.rate_hz),
        ticks_per_row_(experiment.ticks_per_row()),
        edges_(static_cast<std::int64_t>(experiment.graph.edges())) {}

  Due At(std::int64_t tick) const {
    if (tick % ticks_per_row_ != 0) return Due::kNothing;
    if (IsNew(tick, 1)) return Due::kAll;
    return edges_ > 0 && edges_ <= kFewEdges && IsNew(tick, kEdgesPerSecond) ? Due::kEdges : Due::kNothing;
  }
  /// Whether the message of this tick says something of edges, of which there may be too many.
  bool ShowsEdges(std::int64_t tick) const { return edges_ > 0 && edges_ <= kMaxEdges && At(tick) != Due::kNothing; }
  bool HasTrailPoint(std::int64_t tick) const {
    return tick % ticks_per_row_ == 0 && IsNew(tick, kTrailPointsPerSecond);
  }

 private:
  static constexpr std::int64_t kEdgesPerSecond = 30, kTrailPointsPerSecond = 5;
  static constexpr std::int64_t kFewEdges = 2000, kMaxEdges = 20000;

  /// Whether a new one of so many parts of a second has begun since the row before.
  bool IsNew(std::int64_t tick, std::int64_t per_second) const {
    return tick == 0 || tick * per_second / rate_hz_ != (tick - ticks_per_row_) * per_second / rate_hz_;
  }

  std::int64_t rate_hz_, ticks_per_row_, edges_;
};

}  // namespace mascot
