#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace mascot {

/// A limit on how long something may stand still. No clock: it is told the time.
class ProgressWatch {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Seconds = std::chrono::duration<double>;

  explicit ProgressWatch(Seconds limit) : limit_(limit) {}
  /// `progress` is a number that changes whenever something has moved. The time runs from the first look that saw the
  /// number as it is. True if by `now` it has been longer than the limit and `grace`.
  bool IsOverdue(std::int64_t progress, Time now, Seconds grace = Seconds::zero());

 private:
  const Seconds limit_;
  std::optional<std::int64_t> seen_;
  Time since_;  // the first look that saw it
};

}  // namespace mascot
