#pragma once

#include <cstdint>
#include <vector>

#include "experiment/pacing.h"

namespace mascot {

/// Collects the timing statistics of a run in real time. No clock: the caller passes in the times.
class PaceMeter {
 public:
  /// The states of a tick were out `lateness_s` after the tick was due.
  void AddTick(double lateness_s) { lateness_s_.push_back(lateness_s); }
  /// The world is stepped with a command that answered the states of `ticks` ticks ago.
  void AddCommand(std::int64_t ticks);
  Pacing Result(double period_s) const;

 private:
  std::vector<double> lateness_s_;
  std::vector<std::uint64_t> commands_;  // by age in ticks
};

}  // namespace mascot
