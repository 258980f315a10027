#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "physics_server/process/timetable.h"

namespace mascot {

/// Decides when the next tick of a run may happen, as people who watch the run ask for it: pause, single steps, pace.
/// It decides nothing about what happens in a tick. No clock: the caller passes in the time.
class TickGate {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// `period_s`: simulated time between two ticks. `pace`: simulated seconds per second; 0: as fast as the machine can.
  TickGate(double period_s, double pace) : period_s_(period_s), pace_(pace) {}

  /// Sets the pace, which counts from the tick before. A pause goes on.
  void SetPace(double pace);
  void Pause();
  /// Ends a pause: the next tick is due a period later.
  void Resume();
  /// Pauses after `ticks` more ticks, each of which may happen at once.
  void Step(std::int64_t ticks);

  bool paused() const { return paused_; }
  /// Whether it is paused, and no step is left.
  bool IsAtRest() const { return paused_ && steps_ == 0; }
  double pace() const { return pace_; }
  /// Whether ticks may happen at any time.
  bool IsOpen() const { return !paused_ && pace_ == 0; }
  /// The earliest time of the next tick; nullopt: there is none until Resume(), Step() or SetPace(). Without a pause,
  /// the tick before counts as having happened at the first call.
  std::optional<Time> Opens(Time now);
  /// Notes that the next tick happens at `now`.
  void OnTick(Time now);

 private:
  const double period_s_;
  double pace_;
  bool paused_ = false;
  std::int64_t steps_ = 0;              // that may be made in this pause
  std::optional<Timetable> timetable_;  // of the ticks since the pace was set, or the last pause
  std::int64_t ticks_ = 0;              // on this timetable
};

}  // namespace mascot
