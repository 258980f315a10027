#pragma once

#include <chrono>
#include <cstdint>

namespace mascot {

/// The timetable of a run in real time: when each tick is due. No clock: the caller passes in the time.
class Timetable {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// Tick 0 is due at `start`, each later tick `period_s` after the one before it.
  Timetable(double period_s, Time start);
  Time Due(std::int64_t tick) const;
  /// `tick` happens at `now`. If that is more than a period late, all later ticks are put off by the same delay: a
  /// machine that cannot keep up falls behind as a whole, because catching up would leave the agents even less time.
  void OnTick(std::int64_t tick, Time now);

 private:
  std::chrono::nanoseconds Periods(double count) const;

  const double period_s_;
  Time start_;
};

}  // namespace mascot
