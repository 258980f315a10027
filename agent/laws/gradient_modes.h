#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "agent/law_figures.h"
#include "agent/laws/quadratic_costs.h"

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
  double first_m_ = -1, newest_m_ = 0;                         // largest distances of an estimate
  std::int64_t newest_ = -1, last_far_ = -1, last_near_ = -1;  // ticks: of 1e-7, of 1e-12 of the first or more
};

}  // namespace mascot
