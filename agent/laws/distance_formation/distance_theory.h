#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "agent/laws/law_figures.h"
#include "agent/laws/parts/rigidity.h"

namespace mascot {

struct DistanceFormationParams final : LawParams {
  std::vector<Eigen::Vector3d> d_W;  ///< each agent's place, by id - 1 (m)
  double gain = 0;                   ///< 1/(m^2 s)
};

/// A team has its shape if each distance is off by less than this share of it.
inline constexpr double kShapeShare = 0.01;
/// The largest error of a distance between neighbours (m), or as a share of the distance of their places.
double LargestDistanceError(std::span<const Bar> bars, const LawConfig& law, std::span<const Eigen::Vector3d> p_W,
                            bool as_share);

/// LawEntry::predict of the law distance_formation.
LawTheory PredictDistanceFormation(const Experiment& experiment);

}  // namespace mascot
