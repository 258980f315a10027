#pragma once

#include <cmath>
#include <vector>

namespace mascot {

/// |z|_sigma = (sqrt(1 + epsilon |z|^2) - 1) / epsilon, of a vector of length `l`: a norm that is smooth at 0. In this
/// form nothing cancels, however small epsilon |z|^2 is.
inline double SigmaNorm(double l, double epsilon) { return l * l / (std::sqrt(1 + epsilon * l * l) + 1); }

/// rho_h(share): 1 up to the share `from`, 0 from 1 on, smooth between them.
double Rho(double share, double from);

/// What two alpha agents do to each other in Olfati-Saber's flocking (2006), with |a| = |b| = 1 in its phi: they repel
/// each other below the distance d, attract each other above it, and do nothing from the range r on.
class AlphaPair {
 public:
  /// From the share `bump` of r_alpha = |r|_sigma on, the forces fade.
  AlphaPair(double distance_m, double range_m, double epsilon, double bump);

  double range_m() const { return range_m_; }
  /// a_ij = rho_h(|z|_sigma / r_alpha) at a distance of `l` (m): 1 when near, 0 from the range on.
  double Weight(double l) const { return Rho(SigmaNorm(l, epsilon_) / r_alpha_, bump_); }
  /// phi_alpha(|z|_sigma) / sqrt(1 + epsilon |z|^2): the pull along z, per length of z.
  double Stiffness(double l) const { return Action(SigmaNorm(l, epsilon_)) / std::sqrt(1 + epsilon_ * l * l); }
  /// psi_alpha(|z|_sigma) = integral of phi_alpha from |d|_sigma on: the potential of the pull, 0 at the distance d.
  double Potential(double l) const { return TillRange(d_alpha_) - TillRange(SigmaNorm(l, epsilon_)); }
  /// At least the largest curvature of the potential, in any direction.
  double LargestCurvature() const;

 private:
  double Action(double s) const;  // phi_alpha
  /// The integral of phi_alpha from `s` to r_alpha.
  double TillRange(double s) const;
  /// The same between two v, where agents fade.
  double Fading(double from, double to) const;
  /// At least the largest curvature at |z|_sigma between two values.
  double CurvatureBetween(double s_a, double s_b) const;
  /// The largest |rho_h'| between two shares of r_alpha.
  double SteepestFading(double share_a, double share_b) const;
  double Knot(std::size_t n) const { return first_knot_ + static_cast<double>(n) * knot_step_; }

  double range_m_, epsilon_, bump_, r_alpha_, d_alpha_;
  double first_knot_, knot_step_;   // of v = asinh(s - d_alpha), from where agents begin to fade to the range
  std::vector<double> till_range_;  // TillRange() at the knots
};

}  // namespace mascot
