#pragma once

#include <cstdint>
#include <vector>

#include "experiment/pacing.h"

namespace mascot {

/// Measures how a run in real time keeps to its times. No clock: it is told.
class PaceMeter {
 public:
  void AddTick(double lateness_s) { lateness_s_.push_back(lateness_s); }
  /// A command that answered the states of `ticks` ticks ago is used.
  void AddCommand(std::int64_t ticks);
  Pacing Result(double period_s) const;

 private:
  std::vector<double> lateness_s_;
  std::vector<std::uint64_t> commands_;  // by age in ticks
};

}  // namespace mascot
