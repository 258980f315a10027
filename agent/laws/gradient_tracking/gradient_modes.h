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
inline constexpr int kMostGradientModes = 40;
/// The largest |root| of x+ = W x - step y, y+ = W y + Q (x+ - x), but for the three of sum (y - Q x), which stays as
/// it is: what an error keeps from tick to tick in the long run.
double GradientRadius(const Graph& graph, const std::vector<QuadraticCost>& costs, double step);
/// The warning of a law.step with which that is 1 or more.
std::string UnstableStep(const Graph& graph, const std::vector<QuadraticCost>& costs, double step);

/// How estimates approach the minimum from where the experiment's agents start.
struct GradientApproach {
  std::string silent = {};                   ///< why there is no rate; empty: there is
  PredictedFigure rate = {};                 ///< 1/s: as GradientMeter measures it, by the end of the run or later
  std::optional<HoldsFrom> holds_from = {};  ///< from when on it can be measured
};
/// Iterates the errors, which obey the same equations as the estimates, tick by tick.
GradientApproach ApproachOf(const Experiment& experiment, const std::vector<QuadraticCost>& costs, double step,
                            double radius);

/// When the largest distance of an estimate from the minimum was how far from it, row by row.
class ApproachTicks {
 public:
  void Add(std::int64_t tick, double largest_m);
  double newest_m() const { return newest_m_; }
  /// The last tick with 1e-12 of the first distance or more.
  std::int64_t last_near() const { return last_near_; }
  /// Between the last ticks with 1e-7 and with 1e-12 of the first distance or more, by a tick of `period_s`. Absent:
  /// the newest is one of these, or the first was 0.
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

 private:
  const Experiment& experiment_;
  std::vector<int> ids_;
  Eigen::Vector3d minimum_W_;
  ApproachTicks ticks_;
};

}  // namespace mascot
