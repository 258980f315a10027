#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// How disagreement, the curve of the law (LawEntry::curve) and the speeds of a run have gone, thinned to at most
/// kMaxPoints points: a value of every tick, or of every 2nd, 4th, ...
class Curves {
 public:
  static constexpr std::size_t kMaxPoints = 1200;
  /// Of more agents than this, the fastest, the mean and the slowest speed are kept.
  static constexpr int kMaxSpeeds = 8;

  struct Point {
    std::int64_t tick = 0;
    double disagreement_m = 0;
    std::optional<double> of_law = {};
    std::vector<double> speeds = {};  ///< m/s
  };

  /// Whether Add() would keep a point of this tick.
  bool Wants(std::int64_t tick) const { return tick % every_ == 0 && (points_.empty() || tick > points_.back().tick); }
  /// Adds a point with the speeds of these motions. Ticks increase; those that are not wanted are left out.
  void Add(std::int64_t tick, double disagreement_m, std::optional<double> of_law, std::span<const Motion> motions);

  /// The ticks from one point to the next.
  std::int64_t every() const { return every_; }
  const std::vector<Point>& points() const { return points_; }

 private:
  std::vector<Point> points_;
  std::int64_t every_ = 1;
};

}  // namespace mascot
