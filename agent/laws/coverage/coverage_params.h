#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "agent/laws/coverage/density.h"
#include "agent/laws/coverage/polygon.h"
#include "experiment/read_experiment.h"

namespace mascot {

inline constexpr Key kCoverageParameters[] = {
    key::Rows("region_m", {-1e6, 1e6}, "corners [x, y] of a convex region, counterclockwise").Required(),
    key::Rows("density", {-1e6, 1e6}, "bumps [x, y, width, weight] of Gaussian shape").Otherwise("uniform"),
    key::Number("gain", Above(0, 1000), "pull towards the centroid of the own cell").Default("1.0").Unit("1/s").Live(),
};

struct CoverageParams final : LawParams {
  /// Integrals of the density over `cell`, about `o`.
  Moments Of(const Polygon& cell, const Eigen::Vector2d& o) const {
    return bumps.empty() ? MomentsOf(cell, o) : MomentsOf(cell, o, bumps);
  }

  Polygon region;
  std::vector<GaussianBump> bumps;  ///< none: the density is 1
  double gain = 0;                  ///< 1/s
};

/// Reads the keys above, as LawEntry::read does.
std::shared_ptr<const LawParams> ReadCoverage(const Experiment& experiment, const LawConfig& law, Section& section);

/// The part of the region that is nearer to agent `id` than to the other agents of `ids`; the agents are at `p_W` (m),
/// by id - 1. If agents are at one place, the first of them has the part.
Polygon CellOf(const CoverageParams& params, int id, std::span<const int> ids, std::span<const Eigen::Vector3d> p_W);
/// H: the mean square distance of the region to the nearest of agents `ids` (m^2).
double CoverageCost(const CoverageParams& params, std::span<const int> ids, std::span<const Eigen::Vector3d> p_W);

}  // namespace mascot
