#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws/gradient_tracking/quadratic_costs.h"
#include "agent/laws/law_figures.h"

namespace mascot {

/// w_ij of agents that hear d_i and d_j others.
inline double MetropolisWeight(double d_i, double d_j) { return 1 / (1 + std::max(d_i, d_j)); }

/// Above this many agents, the modes below are not computed.
inline constexpr int kMaxGradientModes = 40;
/// The largest |root| of x+ = W x - step y, y+ = W y + Q (x+ - x), except the three roots of sum (y - Q x), which is
/// constant: the share of an error that remains from tick to tick in the long run.
double GradientRadius(const Graph& graph, const std::vector<QuadraticCost>& costs, double step);
/// The warning of a law.step with which GradientRadius() is 1 or more.
std::string UnstableStep(const Graph& graph, const std::vector<QuadraticCost>& costs, double step);

/// How estimates approach the minimum from the starts of the experiment's agents.
struct GradientApproach {
  std::string silent = {};                   ///< why no rate is predicted; empty: one is
  PredictedFigure rate = {};                 ///< 1/s: as GradientMeter measures it, by the end of the run or later
  std::optional<HoldsFrom> holds_from = {};  ///< the time from which on the rate can be measured
};
/// Iterates the errors, which obey the same equations as the estimates, tick by tick.
GradientApproach ApproachOf(const Experiment& experiment, const std::vector<QuadraticCost>& costs, double step,
                            double radius);

/// Remembers the last ticks at which the largest distance of an estimate from the minimum was above certain shares of
/// the first one.
class ApproachTicks {
 public:
  void Add(std::int64_t tick, double largest_m);
  double newest_m() const { return newest_m_; }
  /// The last tick with 1e-12 of the first distance or more.
  std::int64_t last_near() const { return last_near_; }
  /// The rate (1/s) between the last ticks with 1e-7 and with 1e-12 of the first distance or more; a tick takes
  /// `period_s`. Absent: the newest tick is one of these, or the first distance was 0.
  std::optional<double> rate_per_s(double period_s) const;

 private:
  double first_m_ = -1, newest_m_ = 0;
  std::int64_t newest_ = -1, last_far_ = -1, last_near_ = -1;
};

/// Measures how estimates, the first 3 numbers of each message, approach `minimum_W`.
class GradientMeter final : public LawMeter {
 public:
  GradientMeter(const Experiment& experiment, std::span<const int> ids, const Eigen::Vector3d& minimum_W)
      : experiment_(experiment), ids_(ids.begin(), ids.end()), minimum_W_(minimum_W) {}
  void Add(const TeamRow& row) override;
  std::vector<FigureValues> Figures() const override;
  std::optional<double> Curve() const override { return ticks_.newest_m(); }

 private:
  const Experiment& experiment_;
  std::vector<int> ids_;
  Eigen::Vector3d minimum_W_;
  ApproachTicks ticks_;
};

}  // namespace mascot
