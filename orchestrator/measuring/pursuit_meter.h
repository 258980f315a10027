#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// A child has caught up with its parent while it is this close to it, along each axis of the law.
inline constexpr double kCaughtUp_m = 0.05;

/// Measures on each edge of a law of pursuit (PursuitForm), row by row, when the child has caught up with its parent
/// for good.
class PursuitMeter {
 public:
  struct Edge {
    int child = 0;
    int parent = 0;
    std::optional<double> time_s;  ///< absent: not by the end
  };

  /// Edges are those of the team's law; other laws have none.
  explicit PursuitMeter(const Experiment& experiment);
  /// The next row.
  void Add(std::span<const Motion> motions);
  /// By child.
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
