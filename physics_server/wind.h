#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/random.h"
#include "experiment/physics.h"

namespace mascot {

/// The wind of an experiment, one value per physics step, the same for all bodies. The same seed and step length give
/// the same gusts; another step length gives other gusts with the same statistics.
class Wind {
 public:
  Wind(const WindConfig& config, std::uint64_t seed, double dt_s);
  /// From the next step on, the wind is that of `config`; the gusts go on from their present value.
  void Adopt(const WindConfig& config);
  /// The wind of the next physics step, in W (m/s). The first call is for step 0.
  Eigen::Vector3d Next();

 private:
  Eigen::Vector3d mean_W_;
  double std_m_per_s_ = 0;
  double kept_ = 0;             // rho
  double renewed_m_per_s_ = 0;  // sigma sqrt(1 - rho^2)
  double dt_s_;
  Dice dice_;
  std::int64_t step_ = 0;
  Eigen::Vector3d gust_W_ = Eigen::Vector3d::Zero();  // the gust of the last step
};

}  // namespace mascot
