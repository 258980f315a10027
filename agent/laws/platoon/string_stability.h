#pragma once

#include <complex>
#include <optional>

#include "agent/laws/platoon/following.h"

namespace mascot {

/// How a vehicle that follows its predecessor (Following) passes on the predecessor's motion, if its body is a double
/// integrator that takes the acceleration of a tick exactly. From one vehicle to the next, speeds, accelerations and
/// errors of the distance are multiplied by
///   Gamma(z) = C [(p P + K V) F + z^-m] / (1 + C [p (P + headway V) + K (V + headway / z)] F)
///   C = k z / (z - 1 + k), k = 1 - exp(-h / headway)               the filter of the controller
///   K = d + dd (z - 1) / (h z)
///   F = z^-n [1 - g + g b / (z - 1 + b)], b = 1 - exp(-h / tau), g = tau b / h   lag tau, and delay of n ticks
///   V = h / (z - 1), P = h^2 (z + 1) / (2 (z - 1)^2)               speed and position for an acceleration
/// m ticks old is the message of the predecessor; without feed-forward the term z^-m is not there. For h -> 0 it is
///   Gamma(s) = (1 / H) (G K + D) / (1 + G K),  H = headway s + 1, G = exp(-phi s) / (s^2 (tau s + 1)),
///   K = p + d s + dd s^2, D = exp(-theta s), or 0 without feed-forward
class StringStability {
 public:
  explicit StringStability(const Following& law) : law_(law) {}
  /// |Gamma| at w (rad/s), up to half the control rate.
  double Gain(double w) const { return std::abs(At(w).gamma); }
  /// Whether the vehicle forgets its start: all poles of Gamma lie within the unit circle.
  bool Decays() const;
  /// The largest |Gamma| at any frequency, which for a stable string is 1, at frequency 0. For vehicles that forget
  /// their start.
  double LargestGain() const;
  /// The smallest headway from which on the string is stable; nullopt: not even one of a hundred seconds does it.
  std::optional<double> MinHeadway_s() const;

 private:
  struct Point {
    std::complex<double> gamma;
    std::complex<double> below;  ///< (z - 1)^2 times the denominator of gamma
  };
  Point At(double w) const;

  Following law_;
};

}  // namespace mascot
