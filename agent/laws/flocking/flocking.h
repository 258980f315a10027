#pragma once

#include <Eigen/Core>

#include "agent/laws/flocking/beta_agents.h"
#include "agent/laws/flocking/sigma_norm.h"
#include "experiment/experiment.h"

namespace mascot {

/// The parameters of the law flocking, as its meter and its theory know them, too.
struct FlockParams final : LawParams {
  AlphaPair pair{1, 2, 1, 0};
  BetaAgents beta;
  double c1_alpha = 0, c2_alpha = 0, c1_gamma = 0, c2_gamma = 0;
  Eigen::Vector3d target_W = Eigen::Vector3d::Zero();           ///< where the gamma agent is at the time 0
  Eigen::Vector3d target_velocity_W = Eigen::Vector3d::Zero();  ///< it keeps this velocity

  /// p_r at simulated time `t_s`.
  Eigen::Vector3d Target_W(double t_s) const { return target_W + t_s * target_velocity_W; }
};

}  // namespace mascot
