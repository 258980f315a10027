#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The graph over time, in ticks: which agent hears which, from the schedule, the start and stop times of the agents,
/// and the average losses of the links. graph.range_m is ignored.
struct Timeline {
  /// Ticks during which the graph is constant, up to the next interval.
  struct Interval {
    std::int64_t from = 0;
    Graph graph;           ///< weights times the fraction of samples that arrives; without edges that deliver nothing
    std::vector<bool> on;  ///< whether the law is on, by id - 1
  };

  std::vector<Interval> intervals;  ///< in order; the first begins at tick 0
  std::int64_t cycle_from = 0;      ///< from this tick on, at which an interval begins, the intervals repeat ...
  std::int64_t cycle_ticks = 1;     ///< ... after this many ticks; 1: the last interval lasts for ever

  bool IsConstant() const { return intervals.size() == 1; }
  /// The interval of any tick.
  const Interval& At(std::int64_t tick) const;
  /// Weight with which `hearer` hears the sample that `heard` sent at `tick`; 0: it does not hear it, or `tick` is
  /// before the first.
  double WeightOf(int hearer, int heard, std::int64_t tick) const;
};

/// The timeline of an experiment. Nothing if no small multiple of graph.repeat_s is a whole number of ticks, or if
/// there are more than kMaxIntervals intervals.
std::optional<Timeline> TimelineOf(const Experiment& experiment);

inline constexpr int kMaxIntervals = 1000;

}  // namespace mascot
