#pragma once

#include <Eigen/Core>
#include <vector>

#include "agent/laws/affine_formation/maneuver.h"
#include "agent/laws/law_figures.h"
#include "agent/laws/parts/leaders.h"

namespace mascot {

struct AffineFormationParams final : LawParams {
  double gain = 0;                   ///< 1/s
  std::vector<Eigen::Vector3d> r_W;  ///< each agent's place, by id - 1 (m)
  Maneuver maneuver;                 ///< of the leaders
  LedTeam team{{}, 0};
  Eigen::MatrixXd omega;
};

/// LawEntry::predict of the law affine_formation.
LawTheory PredictAffineFormation(const Experiment& experiment);

}  // namespace mascot
