#include "physics_server/process/tick_gate.h"

namespace mascot {

void TickGate::SetPace(double pace) {
  if (timetable_ && pace > 0) {
    const Time last = timetable_->Due(ticks_);
    timetable_.emplace(period_s_ / pace, last);
  } else {
    timetable_.reset();
  }
  ticks_ = 0;
  pace_ = pace;
}

void TickGate::Pause() {
  paused_ = true;
  steps_ = 0;
}

void TickGate::Resume() {
  if (!paused_) return;
  paused_ = false;
  timetable_.reset();
  ticks_ = 0;
}

void TickGate::Step(std::int64_t ticks) {
  paused_ = true;
  steps_ = ticks;
}

std::optional<TickGate::Time> TickGate::Opens(Time now) {
  if (paused_) return steps_ > 0 ? std::optional(now) : std::nullopt;
  if (pace_ == 0) return now;
  if (!timetable_) timetable_.emplace(period_s_ / pace_, now);
  return timetable_->Due(ticks_ + 1);
}

void TickGate::OnTick(Time now) {
  if (paused_)
    --steps_;
  else if (timetable_)
    timetable_->OnTick(++ticks_, now);
}

}  // namespace mascot
