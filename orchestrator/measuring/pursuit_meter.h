#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// Measures, row by row, when each child of a pursuit law (PursuitForm) has caught up with its parent for good.
class PursuitMeter {
 public:
  struct Edge {
    int child = 0;
    int parent = 0;
    std::optional<double> time_s;  ///< absent: the child has not caught up by the end
    double end_m =
        0;  ///< largest distance along an axis in the last tenth of run.duration_s; of a shorter run, at the end
  };

  /// The edges are those of the team's law. A law without a PursuitForm has no edges.
  explicit PursuitMeter(const Experiment& experiment);
  /// Adds the next row.
  void Add(std::span<const Motion> motions);
  /// In increasing order of the child.
  std::vector<Edge> Result() const;

 private:
  struct Pursuit {
    int child, parent;
    std::int64_t last_apart = -1;  // newest row in which they were farther apart
    double end_m = 0;              // Edge::end_m
  };

  const Experiment& experiment_;
  std::vector<Pursuit> pursuits_;
  std::int64_t rows_ = 0;
};

}  // namespace mascot
