#include "agent/laws/cyclic_pursuit/cyclic_modes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace mascot {

using Complex = std::complex<double>;

namespace {

Complex Turn(double angle_rad) { return {std::cos(angle_rad), std::sin(angle_rad)}; }

/// Positions relative to their centre.
std::vector<Complex> Centred(std::span<const Eigen::Vector2d> points) {
  Complex centre = 0;
  for (const Eigen::Vector2d& p : points) centre += Complex(p.x(), p.y()) / static_cast<double>(points.size());
  std::vector<Complex> z;
  for (const Eigen::Vector2d& p : points) z.push_back(Complex(p.x(), p.y()) - centre);
  return z;
}

}  // namespace

RingMotion RingMotionOf(std::span<const Eigen::Vector2d> before, std::span<const Eigen::Vector2d> now,
                        double period_s) {
  const std::vector<Complex> z = Centred(now), old = Centred(before);
  double squares = 0;
  Complex turn = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    squares += std::norm(z[i]);
    turn += std::conj(old[i]) * z[i];
  }
  return {std::sqrt(squares / static_cast<double>(z.size())), std::atan2(turn.imag(), turn.real()) / period_s};
}

CyclicModes::CyclicModes(std::span<const Eigen::Vector2d> start, double step, double alpha_rad) {
  const std::vector<Complex> z = Centred(start);
  const auto count = static_cast<double>(z.size());
  for (std::size_t m = 1; m < z.size(); ++m) {
    const auto angle_rad = [&](std::size_t i) {
      return 2 * std::numbers::pi * static_cast<double>(m * i % z.size()) / count;
    };
    Complex amplitude = 0;
    for (std::size_t i = 0; i < z.size(); ++i) amplitude += z[i] * Turn(-angle_rad(i)) / count;
    powers_.push_back(std::norm(amplitude) * count);
    factors_.push_back(1.0 + step * Turn(-alpha_rad) * (Turn(angle_rad(1)) - 1.0));
  }
}

RingMotion CyclicModes::At(std::int64_t tick, double period_s) const {
  double squares = 0;
  Complex turn = 0;
  for (std::size_t k = 0; k < factors_.size(); ++k) {
    const double growth = std::norm(factors_[k]);  // of the power, in one tick
    squares += powers_[k] * std::pow(growth, static_cast<double>(tick));
    turn += powers_[k] * std::pow(growth, static_cast<double>(tick - 1)) * factors_[k];
  }
  const double count = static_cast<double>(factors_.size()) + 1;
  return {std::sqrt(squares / count), std::atan2(turn.imag(), turn.real()) / period_s};
}

bool CyclicModes::Meet() const {
  return std::ranges::all_of(factors_, [](const Complex& factor) { return std::norm(factor) < 1; });
}

}  // namespace mascot
