#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace mascot {

/// A limit on how long something may make no progress. No clock: the caller passes in the time.
class ProgressWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Seconds = std::chrono::duration<double>;

  explicit ProgressWatch(Seconds limit) : limit_(limit) {}
  /// True if `progress` has been the same for longer than the limit and `grace`. `progress` is a number that changes
  /// whenever something moves; the time counts from the first call with its current value.
  bool IsOverdue(std::int64_t progress, Time now, Seconds grace = Seconds::zero());
  /// Nobody is waited for now: the time counts from the next call of IsOverdue().
  void Rest() { seen_.reset(); }

 private:
  const Seconds limit_;
  std::optional<std::int64_t> seen_;
  Time since_;  // first call with this value
};

}  // namespace mascot
