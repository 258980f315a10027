#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// A child has caught up with its parent when they are at most this far apart along each axis of the law (m).
inline constexpr double kCaughtUp_m = 0.05;

/// Measures, row by row, when each child of a pursuit law (PursuitForm) has caught up with its parent for good.
class PursuitMeter {
 public:
  struct Edge {
    int child = 0;
    int parent = 0;
    std::optional<double> time_s;  ///< absent: the child has not caught up by the end
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
    std::int64_t last_apart;  // newest row in which they were farther apart
  };

  const Experiment& experiment_;
  std::vector<Pursuit> pursuits_;
  std::int64_t rows_ = 0;
};

}  // namespace mascot
