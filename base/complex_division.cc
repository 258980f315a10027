// Division of complex numbers, which g++ takes from libgcc. For aarch64 that one is compiled with operations that round
// a * b + c once, and so gives other bits than x86-64. This one is the same algorithm (Baudin & Smith, "A robust
// complex division in Scilab", arXiv:1210.4539, 2012, with libgcc's scaling) with each operation rounded.
#include "base/complex_division.h"

#include <cmath>
#include <limits>

namespace mascot {
namespace {

using Limits = std::numeric_limits<double>;

// Where libgcc scales.
constexpr double kBig = Limits::max() / 2, kMin = Limits::min();
constexpr double kMin2 = Limits::epsilon(), kScale = 1 / kMin2, kMax2 = kBig * kMin2;

/// Halves or enlarges all four if the larger part of the divisor needs it. `d` is that part.
void Scale(double& a, double& b, double& c, double& d) {
  const auto times = [&](double factor) {
    a *= factor;
    b *= factor;
    c *= factor;
    d *= factor;
  };
  if (std::abs(d) >= kBig) times(0.5);
  const bool small_a = std::abs(a) < kMin && std::abs(b) < kMax2, small_b = std::abs(b) < kMin && std::abs(a) < kMax2;
  if (std::abs(d) < kMin2 || ((small_a || small_b) && std::abs(d) < kMax2)) times(kScale);
}

double Or0Or1(double x) { return std::copysign(std::isinf(x) ? 1.0 : 0.0, x); }

}  // namespace

std::complex<double> Quotient(std::complex<double> dividend, std::complex<double> divisor) {
  double a = dividend.real(), b = dividend.imag(), c = divisor.real(), d = divisor.imag(), x = 0, y = 0;
  if (std::abs(c) < std::abs(d)) {
    Scale(a, b, c, d);
    const double ratio = c / d, denominator = c * ratio + d;
    const bool is_normal = std::abs(ratio) > kMin;
    x = ((is_normal ? a * ratio : c * (a / d)) + b) / denominator;
    y = ((is_normal ? b * ratio : c * (b / d)) - a) / denominator;
  } else {
    Scale(a, b, d, c);
    const double ratio = d / c, denominator = d * ratio + c;
    const bool is_normal = std::abs(ratio) > kMin;
    x = ((is_normal ? b * ratio : d * (b / c)) + a) / denominator;
    y = (b - (is_normal ? a * ratio : d * (a / c))) / denominator;
  }
  if (!std::isnan(x) || !std::isnan(y)) return {x, y};
  // As annex G of the C standard has it: something by zero, infinite by finite, finite by infinite.
  constexpr double kInfinity = Limits::infinity();
  if (c == 0 && d == 0 && (!std::isnan(a) || !std::isnan(b)))
    return {std::copysign(kInfinity, c) * a, std::copysign(kInfinity, c) * b};
  if ((std::isinf(a) || std::isinf(b)) && std::isfinite(c) && std::isfinite(d)) {
    a = Or0Or1(a);
    b = Or0Or1(b);
    return {kInfinity * (a * c + b * d), kInfinity * (b * c - a * d)};
  }
  if ((std::isinf(c) || std::isinf(d)) && std::isfinite(a) && std::isfinite(b)) {
    c = Or0Or1(c);
    d = Or0Or1(d);
    return {0.0 * (a * c + b * d), 0.0 * (b * c - a * d)};
  }
  return {x, y};
}

}  // namespace mascot

#ifdef __aarch64__
/// libgcc's name of it: (a + ib) / (c + id).
extern "C" _Complex double __divdc3(double a, double b, double c, double d) {
  const std::complex<double> quotient = mascot::Quotient({a, b}, {c, d});
  _Complex double result;
  __real__ result = quotient.real();
  __imag__ result = quotient.imag();
  return result;
}
#endif
