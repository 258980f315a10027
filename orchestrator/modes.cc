#include "orchestrator/modes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mascot {
namespace {

using Complex = std::complex<double>;

constexpr double kSettled = 0.02;

/// Roots of s^2 + b s + c; the smaller one from the product, which keeps its digits when it is tiny.
std::array<Complex, 2> Roots(Complex b, Complex c) {
  const Complex root = std::sqrt(b * b - 4.0 * c);
  const Complex larger = -0.5 * (std::abs(b + root) > std::abs(b - root) ? b + root : b - root);
  return {larger == 0.0 ? 0.0 : c / larger, larger};
}

double Rate(const LinearMode& mode) {
  const auto roots = Roots(mode.damping, mode.stiffness);
  return -std::max(roots[0].real(), roots[1].real());
}

/// x(t) from x = 1 at rest.
Complex FromRest(Complex s1, Complex s2, double t) {
  const Complex gap = (s2 - s1) * t;
  if (std::abs(gap) < 1e-4) return (1.0 - s1 * t * (1.0 + gap / 2.0)) * std::exp(s1 * t);  // s1 = s2, to first order
  return (s2 * std::exp(s1 * t) - s1 * std::exp(s2 * t)) / (s2 - s1);
}

}  // namespace

bool Decays(const LinearMode& mode) { return mode.stiffness.real() > 0 && mode.damping > LeastDamping(mode.stiffness); }

double LeastDamping(std::complex<double> stiffness) {
  // s = i y on the edge of stability: y^2 = Re k and damping y = -Im k.
  return std::abs(stiffness.imag()) / std::sqrt(stiffness.real());
}

bool DecaysSampled(const LinearMode& mode, double period_s) {
  // p+ = p + h v + h^2 u / 2, v+ = v + h u, u = -stiffness p - damping v: characteristic z^2 - trace z + determinant.
  const double h = period_s;
  const Complex pull = h * h * mode.stiffness / 2.0;
  const Complex trace = 2.0 - h * mode.damping - pull;
  const Complex determinant = 1.0 - h * mode.damping + pull;
  const auto z = Roots(-trace, determinant);
  return std::abs(z[0]) < 1 && std::abs(z[1]) < 1;
}

double LongestPeriod(std::span<const LinearMode> modes, double period_s) {
  const auto decay = [modes](double h) {
    return std::all_of(modes.begin(), modes.end(), [h](const LinearMode& mode) { return DecaysSampled(mode, h); });
  };
  if (decay(period_s)) return period_s;
  double good = 0;
  double bad = period_s;
  for (int halving = 0; halving < 50; ++halving) (decay((good + bad) / 2) ? good : bad) = (good + bad) / 2;
  return good;
}

double SettlingTime(const LinearMode& mode) {
  const auto [s1, s2] = Roots(mode.damping, mode.stiffness);
  const double rate = Rate(mode);
  // |x| <= (1 + |s1| t) e^(-rate t), and the right side falls from t = 1 / rate on.
  double horizon = 1 / rate;
  while ((1 + std::abs(s1) * horizon) * std::exp(-rate * horizon) > kSettled) horizon *= 1.1;
  constexpr int kSteps = 4000;
  for (int step = kSteps; step > 0; --step) {
    const double t = horizon * step / kSteps;
    if (std::abs(FromRest(s1, s2, t)) > kSettled) return t;
  }
  return 0;
}

double SettlingTime(std::span<const LinearMode> modes) {
  double slowest = 0;
  for (const LinearMode& mode : modes) slowest = slowest == 0 ? Rate(mode) : std::min(slowest, Rate(mode));
  // From rest a mode of rate r settles between 3.9 / r and 5.9 / r: faster ones than these cannot be the last.
  double settling_s = 0;
  for (const LinearMode& mode : modes) {
    if (Rate(mode) <= 1.6 * slowest) settling_s = std::max(settling_s, SettlingTime(mode));
  }
  return settling_s;
}

}  // namespace mascot
