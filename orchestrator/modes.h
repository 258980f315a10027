#pragma once

#include <complex>
#include <span>

namespace mascot {

/// One mode of a linear network of double integrators: x'' + damping x' + stiffness x = 0. The stiffness is
/// the gain times an eigenvalue of the Laplacian, complex on a directed graph.
struct LinearMode {
  double damping = 0;                  ///< 1/s
  std::complex<double> stiffness = 0;  ///< 1/s^2
};

/// Both roots of s^2 + damping s + stiffness have a negative real part.
bool Decays(const LinearMode& mode);
/// The same with the law evaluated every `period_s` and its acceleration held in between.
bool DecaysSampled(const LinearMode& mode, double period_s);
/// The damping above which a mode of this stiffness decays.
double LeastDamping(std::complex<double> stiffness);
/// The longest period, up to `period_s`, at which all modes still decay, given that they do in continuous time.
double LongestPeriod(std::span<const LinearMode> modes, double period_s);
/// Time after which |x| stays within 2 % of its start, from rest, to a relative 1e-3, for a mode that decays.
double SettlingTime(const LinearMode& mode);
/// Of all modes the longest.
double SettlingTime(std::span<const LinearMode> modes);

}  // namespace mascot
