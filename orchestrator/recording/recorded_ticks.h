#pragma once

#include <algorithm>
#include <cstdint>

namespace mascot {

/// The ticks of which a recording has rows, as record.rate_hz says: 0, n, 2n, ..., and the last tick of the run.
class RecordedTicks {
 public:
  /// `ticks`: number of ticks of the run; `every`: n.
  RecordedTicks(std::int64_t ticks, std::int64_t every) : ticks_(ticks), every_(every) {}

  std::int64_t rows() const { return ticks_ < 1 ? 0 : (ticks_ - 1 + every_ - 1) / every_ + 1; }
  std::int64_t last() const { return ticks_ - 1; }
  /// The tick of a row, counted from 0.
  std::int64_t TickOf(std::int64_t row) const { return std::min(row * every_, ticks_ - 1); }
  /// The row of a tick, or the newest before it.
  std::int64_t RowAt(std::int64_t tick) const { return tick >= ticks_ - 1 ? rows() - 1 : tick / every_; }
  /// The first tick with a row after this one; last() + 1: there is none.
  std::int64_t TickAfter(std::int64_t tick) const { return tick >= last() ? last() + 1 : TickOf(RowAt(tick) + 1); }
  bool Has(std::int64_t tick) const { return tick < ticks_ && (tick % every_ == 0 || tick == ticks_ - 1); }

 private:
  std::int64_t ticks_, every_;
};

}  // namespace mascot
