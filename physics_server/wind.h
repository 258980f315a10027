#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "experiment/physics.h"
#include "experiment/random.h"

namespace mascot {

/// The wind of an experiment, one value per physics step, common to all bodies. The same seed and step length give the
/// same gusts; another step length gives others with the same statistics.
class Wind {
 public:
  Wind(const WindConfig& config, std::uint64_t seed, double dt_s);
  /// In W (m/s): of step 0 when called first, then of step 1, ...
  Eigen::Vector3d Next();

 private:
  Eigen::Vector3d mean_W_;
  double std_m_per_s_;
  double kept_;             // rho
  double renewed_m_per_s_;  // sigma sqrt(1 - rho^2)
  Dice dice_;
  std::int64_t step_ = 0;
  Eigen::Vector3d gust_W_ = Eigen::Vector3d::Zero();  // of the step before
};

}  // namespace mascot
