#pragma once

#include <complex>
#include <optional>
#include <span>

namespace mascot {

/// One mode of a linear team: x' + stiffness x = 0 of agents that are driven by velocity, else
/// x'' + damping x' + stiffness x = 0. Both are complex on a directed graph: damping = b + g lambda,
/// stiffness = p lambda for an eigenvalue lambda of the Laplacian.
struct LinearMode {
  std::complex<double> damping = 0;    ///< 1/s
  std::complex<double> stiffness = 0;  ///< 1/s^2; of order 1: 1/s
  int order = 2;
  /// Of order 2, sampled with period h: x+ = x + h v + hold h^2 u, v+ = v + h u. An acceleration held over the tick:
  /// 1/2; one that was added to a velocity that is held: 1.
  double hold = 0.5;
};

/// Every root of the mode's polynomial has a negative real part.
bool Decays(const LinearMode& mode);
/// The same with the law evaluated every `period_s` and its answer held in between.
bool DecaysSampled(const LinearMode& mode, double period_s);
/// The damping b of an agent's own velocity above which s^2 + (b + g lambda) s + p lambda decays.
double LeastDamping(double p, double g, std::complex<double> lambda);
/// The gain g of relative velocities above which it does, given b (Ren & Atkins, 2007, for b = 0).
double LeastRelativeDamping(double p, double b, std::complex<double> lambda);
/// The longest period below which all modes decay, given that they do in continuous time; infinite without modes.
double LongestPeriod(std::span<const LinearMode> modes);
/// 1/s: how fast the slowest mode decays when sampled.
double DecayRate(std::span<const LinearMode> modes, double period_s);
/// Time after which |x| stays within 2 % of its start, from rest, for a mode that decays when sampled.
double SettlingTime(const LinearMode& mode, double period_s);
/// Of all modes the longest.
double SettlingTime(std::span<const LinearMode> modes, double period_s);
/// The delay of all that the law hears and measures, at which the mode stops to decay, in continuous time.
double OwnDelayMargin(const LinearMode& mode);

}  // namespace mascot
