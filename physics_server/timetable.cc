#include "physics_server/timetable.h"

namespace mascot {

Timetable::Timetable(double period_s, Time start) : period_s_(period_s), start_(start) {}

std::chrono::nanoseconds Timetable::Periods(double count) const {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(count * period_s_ * 1e9));
}

Timetable::Time Timetable::Due(std::int64_t tick) const { return start_ + Periods(static_cast<double>(tick)); }

void Timetable::OnTick(std::int64_t tick, Time now) {
  if (const auto late = now - Due(tick); late > Periods(1)) start_ += late;
}

}  // namespace mascot
