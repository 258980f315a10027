#include "agent/laws/flocking/flock_energy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "agent/laws/parts/agreement.h"

namespace mascot {

FlockCentre CentreOf(std::span<const Motion> motions, std::span<const int> ids, Axes axes) {
  FlockCentre centre;
  for (const int id : ids) {
    const Motion& motion = motions[static_cast<std::size_t>(id - 1)];
    centre.p_W += Along(axes, motion.p_WB) / static_cast<double>(ids.size());
    centre.v_W += Along(axes, motion.v_WB) / static_cast<double>(ids.size());
  }
  return centre;
}

double FlockEnergy(const FlockParams& params, const Graph& graph, std::span<const Motion> motions,
                   std::span<const int> ids, Axes axes) {
  const FlockCentre centre = CentreOf(motions, ids, axes);
  double energy = 0;
  ForEachPair(graph, motions, ids, axes, [&](int /*i*/, const Graph::Neighbour& j, double l) {
    energy += j.weight * params.c1_alpha * params.pair.Potential(l);
  });
  for (const int id : ids) {
    const Motion& motion = motions[static_cast<std::size_t>(id - 1)];
    energy += params.c1_gamma * (Along(axes, motion.p_WB) - centre.p_W).squaredNorm() / 2;
    energy += (Along(axes, motion.v_WB) - centre.v_W).squaredNorm() / 2;
  }
  return energy;
}

std::string WhyRangeCuts(const Experiment& experiment, const FlockParams& params) {
  const double range_m = experiment.schedule.range_m(), reach_m = params.pair.range_m();
  if (range_m == 0) return "";
  if (range_m < reach_m) return fmt::format("graph.range_m is less than the {:.4g} m that the law reaches", reach_m);
  if (experiment.law.axes == Axes::kXyz) return "";
  double low_m = experiment.agents.front().p_W.z(), high_m = low_m;
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.v_W.z() != 0) return "graph.range_m is of distances in space, and agents start with a vertical speed";
    low_m = std::min(low_m, agent.p_W.z());
    high_m = std::max(high_m, agent.p_W.z());
  }
  const double needed_m = std::hypot(reach_m, high_m - low_m);
  if (range_m >= needed_m) return "";
  return fmt::format(
      "graph.range_m is of distances in space: at heights {:.4g} m apart it takes {:.4g} m to hear all "
      "that the law reaches",
      high_m - low_m, needed_m);
}

// Deviations x from the centre obey x'' = -grad U(x) - D x', with a force that is held for a tick h. With F = grad U
// and w the mean velocity of a tick, the energy grows by at most -h w'(D w + h D F / 2) / (1 - h D / 2) + h^2 C |w|^2 /
// 2, where C is the largest curvature of U. Along an eigenvector of D, n its eigenvalue by (1 - h D / 2), this is
// largest as h^3 n^2 F^2 / (16 (n - h C / 2)), a convex function of n. And |F|^2 <= 2 C U.
std::optional<double> FlockEnergyGrowth(const Experiment& experiment, const FlockParams& params) {
  const double h = experiment.period_s(), degree = LargestDegree(experiment.graph);
  const double curvature = params.c1_gamma + 2 * degree * params.c1_alpha * params.pair.LargestCurvature();
  double worst = 0;
  for (const double damping : {params.c2_gamma, params.c2_gamma + 2 * degree * params.c2_alpha}) {
    if (h * damping >= 2) return std::nullopt;
    const double n = damping / (1 - h * damping / 2), rest = n - h * curvature / 2;
    if (rest <= 0) return std::nullopt;
    worst = std::max(worst, n * n / rest);
  }
  const double share = h * h * h / 8 * curvature * worst;
  const double bound = share * std::pow(1 + share, experiment.ticks());
  return bound < 1 ? std::optional(bound) : std::nullopt;  // more is no bound
}

}  // namespace mascot
