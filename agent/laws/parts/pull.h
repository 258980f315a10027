#pragma once

#include <Eigen/Core>
#include <span>

#include "agent/laws/law.h"

namespace mascot {

/// sum_j a_ij (p_j - p_i), in W (m): the pull of all neighbours heard, row i of -L p.
inline Eigen::Vector3d Pull_W(const Motion& self, std::span<const Heard> heard) {
  Eigen::Vector3d pull_W = Eigen::Vector3d::Zero();
  for (const Heard& j : heard) pull_W += j.weight * (j.motion.p_WB - self.p_WB);
  return pull_W;
}

}  // namespace mascot
