#include "physics_server/process/timetable.h"

#include <algorithm>

namespace mascot {

namespace {
// Longer than any run, and nanoseconds can count it.
constexpr double kForever_s = 4e9;
}  // namespace

Timetable::Timetable(double period_s, Time start) : period_s_(std::min(period_s, kForever_s)), start_(start) {}

std::chrono::nanoseconds Timetable::Periods(double count) const {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(std::min(count * period_s_, kForever_s) * 1e9));
}

Timetable::Time Timetable::Due(std::int64_t tick) const { return start_ + Periods(static_cast<double>(tick)); }

void Timetable::OnTick(std::int64_t tick, Time now) {
  if (const auto late = now - Due(tick); late > Periods(1)) start_ += late;
}

}  // namespace mascot
