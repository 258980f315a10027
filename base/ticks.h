#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mascot {

namespace ticks_internal {
constexpr double kRounding = 1e-6;  // tolerance for rounding, in ticks
}

/// The ticks that `time_s` takes, rounded up; but a time that is a whole number of ticks except for a rounding error is
/// that number.
inline std::int64_t TicksRoundedUp(double time_s, int rate_hz) {
  return std::max<std::int64_t>(0, std::llround(std::ceil(time_s * rate_hz - ticks_internal::kRounding)));
}

/// The ticks from one event of a periodic kind to the next, rounded up in the same way: at least one.
inline std::int64_t PeriodInTicks(double period_s, int rate_hz) {
  return std::max<std::int64_t>(1, TicksRoundedUp(period_s, rate_hz));
}

/// The whole ticks within `time_s`, with the same tolerance for rounding errors.
inline std::int64_t TicksRoundedDown(double time_s, int rate_hz) {
  return std::llround(std::floor(time_s * rate_hz + ticks_internal::kRounding));
}

}  // namespace mascot
