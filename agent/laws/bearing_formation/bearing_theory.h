#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "agent/laws/law_figures.h"
#include "agent/laws/parts/rigidity.h"

namespace mascot {

struct BearingFormationParams final : LawParams {
  std::vector<Eigen::Vector3d> d_W;  ///< each agent's place, by id - 1 (m)
  double gain = 0;                   ///< m/s
};

/// A team has its shape if its directions are off by less than this.
inline constexpr double kSettled_deg = 1;
/// The largest error of the direction from an agent to a neighbour (degrees).
double LargestTurn_deg(std::span<const Bar> bars, const LawConfig& law, std::span<const Eigen::Vector3d> p_W);

/// LawEntry::predict of the law bearing_formation.
LawTheory PredictBearingFormation(const Experiment& experiment);

}  // namespace mascot
