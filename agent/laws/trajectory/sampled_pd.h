#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

namespace mascot {

using Complex = std::complex<double>;

/// A double integrator under a = u - p x - d v, along one axis, whose acceleration is held for a tick of h seconds:
///   x+ = x + h v + h^2 a / 2,  v+ = v + h a
struct SampledPd {
  double p = 0, d = 0, h = 0;

  /// The position x in answer to u = z^k, in the long run: x = Response(z) z^k.
  Complex Response(Complex z) const {
    const Complex s = z - 1.0;
    return h * h / 2 * (z + 1.0) / (s * s + s * (h * d + h * h * p / 2) + h * h * p);
  }
  /// The largest magnitude of the poles: by this factor, or faster, the effect of the start decays in a tick.
  double Radius() const {
    const double half = (h * d + h * h * p / 2) / 2, square = half * half - h * h * p;
    if (square < 0) return std::sqrt((1 - half) * (1 - half) - square);
    return std::max(std::abs(1 - half + std::sqrt(square)), std::abs(1 - half - std::sqrt(square)));
  }
};

}  // namespace mascot
