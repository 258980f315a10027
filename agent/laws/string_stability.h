#pragma once

#include <algorithm>
#include <cmath>

#include "agent/laws/sampled_pd.h"

namespace mascot {

/// How a vehicle that follows its predecessor at spacing + headway v passes on what that one does: a double integrator
/// with the acceleration
///   a_i = p (x_{i-1} - x_i - spacing - headway v_i) + d (v_{i-1} - v_i)
/// held for a tick of h seconds. From one vehicle to the next speeds, and errors of the spacing, are multiplied by
///   Gamma(z) = [h^2 p (z + 1) / 2 + h d (z - 1)] / [(z-1)^2 + m (z-1) + q],  m = h (d + p headway) + h^2 p / 2, q =
///   h^2 p
/// For h -> 0 it is (d s + p) / (s^2 + (d + p headway) s + p). On the unit circle, with x = 1 - cos(w h),
///   |Gamma|^2 = (q^2 + B x) / (q^2 + C x + D x^2),  B = 2 (h d)^2 - q^2 / 2, C = 2 m^2 - 4 q - 2 q m, D = 4 (1 - m +
///   q)
struct StringStability {
  double p = 0, d = 0, headway_s = 0, h = 0;

  SampledPd Loop() const { return {.p = p, .d = d + p * headway_s, .h = h}; }
  /// |Gamma| at w (rad/s).
  double Gain(double w) const { return std::sqrt(Square(1 - std::cos(w * h))); }
  /// The largest |Gamma| at any frequency: 1, at rest, for a string that is stable.
  double LargestGain() const {
    // The derivative by x is 0 where B D x^2 + 2 D q^2 x - q^2 (B - C) = 0.
    const double bd = B() * D(), square = D() * D() * q() * q() + bd * (B() - C());
    double largest = std::max(1.0, Square(2));
    if (B() <= C() || square < 0) return std::sqrt(largest);
    const double x = q() * (B() - C()) / (std::sqrt(square) + D() * q());
    if (x > 0 && x < 2) largest = std::max(largest, Square(x));
    return std::sqrt(largest);
  }
  /// The smallest headway with LargestGain() = 1: B = C there, whatever h is.
  double LeastHeadway_s() const { return (std::sqrt(d * d + 2 * p) - d) / p; }
  /// At most this share of the start is left after `ticks` in a vehicle that `before` others drive in front of, each
  /// with two poles: of the terms of a cascade, those of the Poisson distribution.
  double RestOfStart(double ticks, int before) const {
    const double mean = -std::log(Loop().Radius()) * ticks;
    double term = std::exp(-mean), rest = 0;
    for (int k = 0; k < 2 * before; ++k, term *= mean / k) rest += term;
    return rest;
  }

 private:
  double q() const { return h * h * p; }
  double m() const { return h * (d + p * headway_s) + h * h * p / 2; }
  double B() const { return 2 * h * h * d * d - q() * q() / 2; }
  double C() const { return 2 * m() * m() - 4 * q() - 2 * q() * m(); }
  double D() const { return 4 * (1 - m() + q()); }
  double Square(double x) const { return (q() * q() + B() * x) / (q() * q() + C() * x + D() * x * x); }
};

}  // namespace mascot
