#include "orchestrator/live/recorded/playback.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mascot {

Answer Playback::Ask(const Request& request) {
  const std::lock_guard lock(mutex_);
  Advance();
  const Answer answer = Grant(request);
  if (answer.granted) ++requests_;
  asked_.notify_all();
  return answer;
}

Answer Playback::Grant(const Request& request) {
  switch (request.kind) {
    case Request::Kind::kPause:
      plays_ = false;
      return {true, "paused at " + Where()};
    case Request::Kind::kResume:
      if (tick_ >= static_cast<double>(last_tick_)) tick_ = 0;
      plays_ = true;
      return {true, "plays from " + Where()};
    case Request::Kind::kStep:
      if (!std::isfinite(request.number)) return {false, "step: expected a number of ticks"};
      plays_ = false;
      return Step(std::round(request.number));
    case Request::Kind::kSeek:
      if (!std::isfinite(request.number)) return {false, "seek: expected a time in seconds"};
      return GoTo(std::round(request.number * rate_hz_));
    case Request::Kind::kPace:
      if (!(request.number >= kSlowest && request.number <= kFastest))
        return {false, fmt::format("speed: expected a number in [{}, {}], got {}", kSlowest, kFastest, request.number)};
      speed_ = request.number;
      return {true, fmt::format("plays {} simulated seconds a second", speed_)};
    case Request::Kind::kStop:
    case Request::Kind::kEvent:
    case Request::Kind::kStart:
    case Request::Kind::kLand:
    case Request::Kind::kKill:
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

/// Goes on by so many rows, or back.
Answer Playback::Step(double rows) {
  const double row = static_cast<double>(ticks_.RowAt(static_cast<std::int64_t>(tick_))) + rows;
  const double last = static_cast<double>(ticks_.rows() - 1);
  if (row > last) return GoTo(static_cast<double>(last_tick_) + row - last);
  return GoTo(static_cast<double>(ticks_.TickOf(static_cast<std::int64_t>(std::max(row, 0.0)))));
}

Answer Playback::GoTo(double tick) {
  tick_ = std::clamp(tick, 0.0, static_cast<double>(last_tick_));
  return {true, "at " + Where() + (tick > tick_ ? ", where the recording ends" : "")};
}

std::string Playback::Where() const {
  const double tick = std::floor(tick_);
  return fmt::format("tick {} ({} s)", static_cast<std::int64_t>(tick), tick / rate_hz_);
}

Playback::PlaybackState Playback::Now() {
  const std::lock_guard lock(mutex_);
  Advance();
  heard_ = requests_;
  return {static_cast<std::int64_t>(tick_), plays_, speed_};
}

void Playback::Wait(const std::stop_token& over, WallClock::time_point until) {
  std::unique_lock lock(mutex_);
  asked_.wait_until(lock, over, until, [this] { return requests_ != heard_; });
}

}  // namespace mascot
