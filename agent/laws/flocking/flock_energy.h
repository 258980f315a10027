#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <optional>
#include <span>
#include <string>

#include "agent/laws/flocking/flocking.h"
#include "base/motion.h"

namespace mascot {

/// Mean position and velocity of a flock, along the axes of its law.
struct FlockCentre {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero(), v_W = Eigen::Vector3d::Zero();
};

FlockCentre CentreOf(std::span<const Motion> motions, std::span<const int> ids, Axes axes);

/// Calls visit(i, neighbour, distance) for each pair of agents `ids` (sorted) that hear each other, along `axes`.
template <class Visit>
void ForEachPair(const Graph& graph, std::span<const Motion> motions, std::span<const int> ids, Axes axes,
                 const Visit& visit) {
  for (const int i : ids)
    for (const Graph::Neighbour& j : graph.HeardBy(i)) {
      if (j.id < i || !std::binary_search(ids.begin(), ids.end(), j.id)) continue;
      const auto p_W = [&](int id) { return motions[static_cast<std::size_t>(id - 1)].p_WB; };
      visit(i, j, Along(axes, p_W(j.id) - p_W(i)).norm());
    }
}

/// The structural energy: potentials of all pairs and of the pull to the centre, and kinetic energy about the centre.
double FlockEnergy(const FlockParams& params, const Graph& graph, std::span<const Motion> motions,
                   std::span<const int> ids, Axes axes);
/// Why graph.range_m cuts off pairs that are part of the energy, so that the energy jumps; empty: it does not. The
/// range is a distance in space; the law uses distances along its axes.
std::string WhyRangeCuts(const Experiment& experiment, const FlockParams& params);
/// The most by which this energy may grow in a tick because a command holds, as a share of the energy at the start.
/// Nullopt: theory does not say, because the period is too long for the gains and for the number of agents that may be
/// near.
std::optional<double> FlockEnergyGrowth(const Experiment& experiment, const FlockParams& params);

}  // namespace mascot
