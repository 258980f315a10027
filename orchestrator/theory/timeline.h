#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Who hears whom when, in ticks: the schedule, who has started and not yet stopped, and what the links deliver on
/// average. Distance aside.
struct Timeline {
  /// From a tick up to the next interval's.
  struct Interval {
    std::int64_t from = 0;
    Graph graph;           ///< weights times the part of samples that arrives; edges that deliver nothing are left out
    std::vector<bool> on;  ///< by id - 1: whose law is on
  };

  std::vector<Interval> intervals;  ///< the first from 0
  std::int64_t cycle_from = 0;      ///< from this tick on, the beginning of an interval, ...
  std::int64_t cycle_ticks = 1;     ///< ... it repeats itself after so many ticks; the last interval alone: 1

  bool IsConstant() const { return intervals.size() == 1; }
  const Interval& At(std::int64_t tick) const;
};

/// Nothing if graph.repeat_s is no multiple of the control period, nor a small fraction of one, or if there are more
/// than kMostIntervals.
std::optional<Timeline> TimelineOf(const Experiment& experiment);

inline constexpr int kMostIntervals = 1000;

}  // namespace mascot
