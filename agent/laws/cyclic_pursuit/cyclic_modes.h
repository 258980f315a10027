#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

namespace mascot {

// The motion of agents in cyclic pursuit, as complex numbers x + i y: exact for single integrators with held
// velocities.

/// The radius of agents that are all at one place is below this, a sum of rounding errors (m).
inline constexpr double kRoundedRadius_m = 1e-9;

/// The two figures of a moving ring at one tick.
struct RingMotion {
  double radius_m = 0;             ///< rms distance from the centre
  double turn_rate_rad_per_s = 0;  ///< mean rate, weighted by the squares of distances, at which agents go round it
};

/// The figures, from the agents' places (m) at two consecutive ticks, `period_s` apart.
RingMotion RingMotionOf(std::span<const Eigen::Vector2d> before, std::span<const Eigen::Vector2d> now, double period_s);

/// Modes of z_i+ = z_i + step R (z_{i+1} - z_i) on the ring, with R a turn to the right by `alpha_rad`. Mode m of N,
/// from 1, has z_i = exp(2 pi m i / N): each tick multiplies it by 1 + step R (exp(2 pi m / N) - 1). The modes are
/// orthogonal.
class CyclicModes {
 public:
  CyclicModes(std::span<const Eigen::Vector2d> start, double step, double alpha_rad);
  /// The figures at `tick`, from 1. Infinite if the ring has grown beyond all numbers.
  RingMotion At(std::int64_t tick, double period_s) const;
  /// Whether every mode shrinks, so that agents meet in their centre.
  bool Meet() const;

 private:
  std::vector<std::complex<double>> factors_;
  std::vector<double> powers_;  // of each mode at tick 0: the sum of squares of distances that is due to it
};

}  // namespace mascot
