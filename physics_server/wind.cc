// Gusts as a first-order Gauss-Markov (Ornstein-Uhlenbeck) process of standard deviation sigma and correlation time
// tau, in each of x, y, z: what the forming filter of Dryden's longitudinal spectrum gives at a constant airspeed
// (MIL-F-8785C). Sampled exactly, whatever the step: Gillespie, "Exact numerical simulation of the Ornstein-Uhlenbeck
// process and its integral", Physical Review E 54 (1996):
//   g+ = rho g + sigma sqrt(1 - rho^2) xi,   rho = exp(-dt / tau),   xi ~ N(0, 1),   g(0) = sigma xi: stationary
#include "physics_server/wind.h"

#include <cmath>

namespace mascot {

Wind::Wind(const WindConfig& config, std::uint64_t seed, double dt_s) : dt_s_(dt_s), dice_(seed, Dice::Stream::kWind) {
  Adopt(config);
}

void Wind::Adopt(const WindConfig& config) {
  mean_W_ = config.mean_m_per_s;
  std_m_per_s_ = config.gust_std_m_per_s;
  kept_ = std::exp(-dt_s_ / config.gust_time_s);
  renewed_m_per_s_ = std_m_per_s_ * std::sqrt(-std::expm1(-2 * dt_s_ / config.gust_time_s));
}

Eigen::Vector3d Wind::Next() {
  if (std_m_per_s_ == 0) return mean_W_;
  const Eigen::Vector3d xi(dice_.Normal(step_, 0), dice_.Normal(step_, 1), dice_.Normal(step_, 2));
  gust_W_ = kept_ * gust_W_ + (step_ == 0 ? std_m_per_s_ : renewed_m_per_s_) * xi;
  ++step_;
  return mean_W_ + gust_W_;
}

}  // namespace mascot
