#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stop_token>

#include "orchestrator/control/run_control.h"
#include "orchestrator/recording/recorded_ticks.h"

namespace mascot {

/// Decides which tick of a recording is shown, by the requests of viewers and by time. Playback begins at tick 0,
/// paused; it pauses at the last tick, and if it is resumed there, it plays from the start. Thread-safe.
class Playback final : public RunControl {
 public:
  using WallClock = std::chrono::steady_clock;
  static constexpr double kSlowest = 0.1, kFastest = 100;  ///< simulated seconds per second

  struct PlaybackState {
    std::int64_t tick = 0;
    bool plays = false;
    double speed = 1;
    bool operator==(const PlaybackState&) const = default;
  };

  /// `ticks`: those of which the recording has rows, which a step goes to. `clock` returns the present time.
  Playback(int rate_hz, const RecordedTicks& ticks, std::function<WallClock::time_point()> clock = WallClock::now)
      : rate_hz_(rate_hz), ticks_(ticks), last_tick_(ticks.last()), clock_(std::move(clock)), since_(clock_()) {}

  Answer Ask(const Request& request) override;
  PlaybackState Now();
  /// Waits for a request, for `over` or until this time.
  void Wait(const std::stop_token& over, WallClock::time_point until);

 private:
  Answer Grant(const Request& request);
  void Advance();
  Answer Step(double rows);
  Answer GoTo(double tick);
  std::string Where() const;

  const int rate_hz_;
  const RecordedTicks ticks_;
  const std::int64_t last_tick_;
  const std::function<WallClock::time_point()> clock_;

  std::mutex mutex_;  // guards what follows
  std::condition_variable_any asked_;
  std::uint64_t requests_ = 0, heard_ = 0;  // granted; of these, seen by Now()
  double tick_ = 0;                         // with its fraction, at since_
  WallClock::time_point since_;
  bool plays_ = false;
  double speed_ = 1;
};

}  // namespace mascot
