#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

inline constexpr auto kCostKeys = std::array{
    key::Points("targets_m", {-1e6, 1e6}, "b_i: where each agent's own cost is least").Otherwise("where each starts"),
    key::Rows("weights", {-1e6, 1e6}, "Q_i of each agent: 1 number, 3 on the diagonal, or 6 (xx, xy, xz, yy, yz, zz)")
        .Otherwise("all 1"),
};

/// An agent's own cost, (x - b)' Q (x - b) / 2.
struct QuadraticCost {
  Eigen::Matrix3d q = Eigen::Matrix3d::Identity();
  Eigen::Vector3d b_W = Eigen::Vector3d::Zero();

  Eigen::Vector3d Gradient(const Eigen::Vector3d& x_W) const { return q * (x_W - b_W); }
};

/// Reads the keys above: one cost for each agent, by id - 1. Notes a mistake unless every Q_i is positive semidefinite
/// and their sum positive definite.
std::vector<QuadraticCost> ReadCosts(const Experiment& experiment, Section& law);
/// The point, in W (m), at which the sum of the costs is least: (sum Q)^-1 sum Q b.
Eigen::Vector3d Minimiser(const std::vector<QuadraticCost>& costs);

}  // namespace mascot
