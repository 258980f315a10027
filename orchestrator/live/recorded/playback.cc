#include "orchestrator/live/recorded/playback.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mascot {

Answer Playback::Ask(const Wish& wish) {
  const std::lock_guard lock(mutex_);
  Advance();
  const Answer answer = Grant(wish);
  if (answer.granted) ++wishes_;
  asked_.notify_all();
  return answer;
}

Answer Playback::Grant(const Wish& wish) {
  switch (wish.kind) {
    case Wish::Kind::kPause:
      plays_ = false;
      return {true, "paused at " + Where()};
    case Wish::Kind::kResume:
      if (tick_ >= static_cast<double>(last_tick_)) tick_ = 0;
      plays_ = true;
      return {true, "plays from " + Where()};
    case Wish::Kind::kStep:
      if (!std::isfinite(wish.number)) return {false, "step: expected a number of ticks"};
      plays_ = false;
      return GoTo(std::floor(tick_) + std::round(wish.number));
    case Wish::Kind::kSeek:
      if (!std::isfinite(wish.number)) return {false, "seek: expected a time in seconds"};
      return GoTo(std::round(wish.number * rate_hz_));
    case Wish::Kind::kPace:
      if (!(wish.number >= kSlowest && wish.number <= kFastest))
        return {false, fmt::format("speed: expected a number in [{}, {}], got {}", kSlowest, kFastest, wish.number)};
      speed_ = wish.number;
      return {true, fmt::format("plays {} simulated seconds a second", speed_)};
    case Wish::Kind::kStop:
    case Wish::Kind::kEvent:
      break;
  }
  return {false, "a recording cannot be changed"};
}

/// Lets time go on up to now.
void Playback::Advance() {
  const auto now = clock_();
  const double passed_s = std::chrono::duration<double>(now - since_).count();
  since_ = now;
  if (!plays_) return;
  tick_ += passed_s * speed_ * rate_hz_;
  if (tick_ < static_cast<double>(last_tick_)) return;
  tick_ = static_cast<double>(last_tick_);
  plays_ = false;
}

Answer Playback::GoTo(double tick) {
  tick_ = std::clamp(tick, 0.0, static_cast<double>(last_tick_));
  return {true, "at " + Where() + (tick > tick_ ? ", where the recording ends" : "")};
}

std::string Playback::Where() const {
  const double tick = std::floor(tick_);
  return fmt::format("tick {} ({} s)", static_cast<std::int64_t>(tick), tick / rate_hz_);
}

Playback::Standing Playback::Now() {
  const std::lock_guard lock(mutex_);
  Advance();
  heard_ = wishes_;
  return {static_cast<std::int64_t>(tick_), plays_, speed_};
}

void Playback::Wait(const std::stop_token& over, WallClock::time_point until) {
  std::unique_lock lock(mutex_);
  asked_.wait_until(lock, over, until, [this] { return wishes_ != heard_; });
}

}  // namespace mascot
