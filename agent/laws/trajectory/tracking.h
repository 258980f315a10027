#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "agent/laws/law_figures.h"
#include "agent/laws/trajectory/reference_path.h"
#include "agent/laws/trajectory/sampled_pd.h"
#include "experiment/experiment.h"

namespace mascot {

inline constexpr LawFigure kTrackingFigures[] = {
    {.name = "tracking_rms_m", .meaning = "rms distance to the trajectory, in the last period of the run"},
    {.name = "lag_s", .meaning = "how late agents are, in that period: mean error along the way by the speed"},
    {.name = "amplitude_ratio", .meaning = "size of the way that was flown in that period, by that of the trajectory"},
};

/// What laws that follow a reference path measure: how far they are from it, behind it, and how large their way is.
struct TrackingFigures {
  std::optional<double> rms_m = {};            ///< of the distance to the reference
  std::optional<double> lag_s = {};            ///< mean of (r - p).v_r by that of |v_r|^2
  std::optional<double> amplitude_ratio = {};  ///< rms distance from the own mean position by that of the reference

  /// In the order of kTrackingFigures.
  std::vector<FigureValues> List() const { return {{rms_m}, {lag_s}, {amplitude_ratio}}; }
};

/// Measures them, of agents that follow one reference from places d_i of their own.
class TrackingMeter {
 public:
  /// `r`: the reference; `q_W` = p - d of an agent at the same time; measured along `axes`.
  void Add(const PathPoint& r, const Eigen::Vector3d& q_W, Axes axes);
  TrackingFigures Figures() const;

 private:
  /// Mean square distance from the mean.
  struct Extent {
    double ticks = 0, squares = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    void Add(const Eigen::Vector3d& x) { ticks += 1, squares += x.squaredNorm(), sum += x; }
    double square() const { return (squares - sum.squaredNorm() / ticks) / ticks; }
  };

  Eigen::Vector3d origin_W_ = Eigen::Vector3d::Zero();  // of the extents: near the path
  Extent flown_, reference_;
  double error_squares_ = 0, error_along_ = 0, speed_squares_ = 0;
};

/// The figures in the long run, of oscillations that a double integrator follows by u = p r + d v_r, and by the
/// acceleration of the middle of the tick with `feed_forward`. Nullopt: an axis needs more than `limit_m_per_s2`.
std::optional<TrackingFigures> SteadyTracking(const ReferencePath& path, const SampledPd& loop, bool feed_forward,
                                              double limit_m_per_s2);

}  // namespace mascot
