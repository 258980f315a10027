#pragma once

#include <complex>
#include <optional>
#include <span>

namespace mascot {

/// One mode of a linear team: x'' + damping x' + stiffness x = 0, or, for order 1, x' + stiffness x = 0. For an
/// eigenvalue lambda of the Laplacian, damping = b + g lambda and stiffness = p lambda; on a directed graph they may be
/// complex.
struct LinearMode {
  std::complex<double> damping = 0;    ///< 1/s
  std::complex<double> stiffness = 0;  ///< 1/s^2; for order 1: 1/s
  int order = 2;
  /// For order 2, sampled with period h: x+ = x + h v + hold h^2 u, v+ = v + h u. 1/2 if the acceleration is held over
  /// the period; 1 if it is added to a velocity that is held.
  double hold = 0.5;
};

/// Whether all roots of the mode's polynomial have negative real parts.
bool Decays(const LinearMode& mode);
/// Whether the mode decays if the law is evaluated every `period_s` and its output is held in between.
bool DecaysSampled(const LinearMode& mode, double period_s);
/// The absolute damping b (1/s) above which s^2 + (b + g lambda) s + p lambda decays.
double MinDamping(double p, double g, std::complex<double> lambda);
/// The gain g of relative velocities (1/s) above which the same decays (for b = 0: Ren & Atkins, 2007).
double MinRelativeDamping(double p, double b, std::complex<double> lambda);
/// The control period (s) below which all modes decay. They must decay in continuous time. Infinite without modes.
double LongestPeriod(std::span<const LinearMode> modes);
/// Decay rate of the slowest mode when sampled (1/s).
double DecayRate(std::span<const LinearMode> modes, double period_s);
/// Time (s) after which |x| stays within 2 % of its initial value, from rest. The mode must decay when sampled.
double SettlingTime(const LinearMode& mode, double period_s);
/// The longest settling time of all modes (s).
double SettlingTime(std::span<const LinearMode> modes, double period_s);
/// The shortest delay (s), equal for neighbours' samples and own state, of whole control periods, with which the
/// sampled mode does not decay. It must decay without. Nothing if the period is so long that the loop gain at half the
/// sampling rate is not below 1.
std::optional<double> OwnDelayMargin(const LinearMode& mode, double period_s);
/// The least whole number that is not smaller than `ticks`, a positive number that is exact but for rounding.
double WholeTicks(double ticks);

}  // namespace mascot
