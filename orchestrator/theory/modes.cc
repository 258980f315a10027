#include "orchestrator/theory/modes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/linear_algebra.h"

namespace mascot {
namespace {

using Complex = std::complex<double>;

constexpr double kSettled = 0.02;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

/// Roots of s^2 + b s + c, the smaller in magnitude first. It is computed from the product c to avoid cancellation.
std::array<Complex, 2> Roots(Complex b, Complex c) {
  const Complex root = std::sqrt(b * b - 4.0 * c);
  const Complex larger = -0.5 * (std::abs(b + root) > std::abs(b - root) ? b + root : b - root);
  return {larger == 0.0 ? 0.0 : c / larger, larger};
}

/// The x >= 0 above which a x^2 + b x + c is positive, for a > 0, b >= 0.
double PositiveRoot(double a, double b, double c) { return c >= 0 ? 0 : -2 * c / (b + std::sqrt(b * b - 4 * a * c)); }

/// The poles z of the sampled mode, as (z - 1) / h to avoid cancellation for short periods h. The mode is sampled as
/// x+ = x + h v + hold h^2 u, v+ = v + h u, u = -stiffness x - damping v. For h = 0, the poles in continuous time.
std::array<Complex, 2> Poles(const LinearMode& mode, double h) {
  if (mode.order == 1) return {-mode.stiffness, -mode.stiffness};
  return Roots(mode.damping + mode.hold * h * mode.stiffness, mode.stiffness);
}

/// ln z of a pole that is given as (z - 1) / h.
Complex Log(Complex pole, double h) {
  return {0.5 * std::log1p(h * (2 * pole.real() + h * std::norm(pole))),
          std::atan2(h * pole.imag(), 1 + h * pole.real())};
}

/// Decay rate of the sampled mode (1/s); h is the period.
double Rate(const LinearMode& mode, double h) {
  const auto poles = Poles(mode, h);
  return -std::max(Log(poles[0], h).real(), Log(poles[1], h).real()) / h;
}

/// Response of a sampled mode that starts at x = 1 from rest.
class FromRest {
 public:
  FromRest(const LinearMode& mode, double h) : poles_(Poles(mode, h)), h_(h) {
    if (Log(poles_[0], h).real() < Log(poles_[1], h).real()) std::swap(poles_[0], poles_[1]);
    for (std::size_t k = 0; k < 2; ++k) logs_[k] = Log(poles_[k], h);
    first_ = poles_[0] + mode.hold * h * mode.stiffness;
  }

  /// x after n ticks.
  Complex At(double n) const {
    const Complex slow = std::exp(n * logs_[0]);
    const Complex gap = poles_[0] - poles_[1];
    if (std::abs(gap) * n * h_ < 1e-4) return slow * (1.0 - first_ * n * h_ / (1.0 + h_ * poles_[0]));  // a double pole
    return slow - first_ * (slow - std::exp(n * logs_[1])) / gap;
  }
  /// Upper bound of |At(n)|; decreases for n h > 1 / rate.
  double Bound(double n) const {
    return (1 + std::abs(first_) * n * h_ / std::abs(1.0 + h_ * poles_[0])) * std::exp(n * logs_[0].real());
  }

 private:
  std::array<Complex, 2> poles_;  // the slower first, as (z - 1) / h
  std::array<Complex, 2> logs_;   // ln z of each
  double h_;
  Complex first_;  // (z of the slower pole - At(1)) / h
};

/// Stability bound of the period (s) of a mode with real damping and stiffness: |det| < 1 and 1 + trace + det > 0
/// (Jury).
double LongestPeriodOfReal(const LinearMode& mode) {
  const double d = mode.damping.real(), k = mode.stiffness.real();
  const double by_determinant = mode.hold < 1 ? d / ((1 - mode.hold) * k) : kUnbounded;
  return std::min(by_determinant, 4 / (d + std::sqrt(d * d - 4 * (1 - 2 * mode.hold) * k)));
}

/// The shortest period (s) at which the mode does not decay. It may be stable again for longer ones.
double LongestPeriod(const LinearMode& mode) {
  if (mode.order == 1) return 2 * mode.stiffness.real() / std::norm(mode.stiffness);
  if (mode.damping.imag() == 0 && mode.stiffness.imag() == 0) return LongestPeriodOfReal(mode);
  double bad = 1e-6 / std::abs(Poles(mode, 0)[1]);
  while (DecaysSampled(mode, bad)) bad *= 2;
  constexpr int kSteps = 500;
  int step = 1;
  while (DecaysSampled(mode, bad * step / kSteps)) ++step;
  double good = bad * (step - 1) / kSteps;
  bad = bad * step / kSteps;
  for (int halving = 0; halving < 50; ++halving) {
    const double middle = (good + bad) / 2;
    (DecaysSampled(mode, middle) ? good : bad) = middle;
  }
  return good;
}

/// `angle` in [-pi, pi] as an angle in (0, 2 pi].
double PositiveAngle(double angle) { return angle > 0 ? angle : angle + 2 * std::numbers::pi; }

}  // namespace

// Condition for s^2 + (a + i b) s + (c + i d): a > 0 and a (a c + b d) > d^2. kBeyond: with a gain exactly at its least
// value the mode must not count as decaying, whatever the rounding.
bool Decays(const LinearMode& mode) {
  constexpr double kBeyond = 1 + 1e-9;
  const Complex d = mode.damping, k = mode.stiffness;
  if (mode.order == 1) return k.real() > 0;
  return d.real() > 0 && d.real() * (d.real() * k.real() + d.imag() * k.imag()) > kBeyond * k.imag() * k.imag();
}

bool DecaysSampled(const LinearMode& mode, double period_s) {
  return std::ranges::all_of(Poles(mode, period_s),
                             [&](Complex pole) { return 2 * pole.real() + period_s * std::norm(pole) < 0; });
}

// The condition of Decays with lambda = x + i y: x b^2 + g (2 x^2 + y^2) b + g^2 x |lambda|^2 - p y^2 > 0.
double MinDamping(double p, double g, std::complex<double> lambda) {
  const double x = lambda.real(), y2 = lambda.imag() * lambda.imag();
  return PositiveRoot(x, g * (2 * x * x + y2), g * g * x * std::norm(lambda) - p * y2);
}

// The same as a condition on g: x |lambda|^2 g^2 + b (2 x^2 + y^2) g + x b^2 - p y^2 > 0.
double MinRelativeDamping(double p, double b, std::complex<double> lambda) {
  const double x = lambda.real(), y2 = lambda.imag() * lambda.imag();
  return PositiveRoot(x * std::norm(lambda), b * (2 * x * x + y2), x * b * b - p * y2);
}

double LongestPeriod(std::span<const LinearMode> modes) {
  double longest_s = kUnbounded;
  for (const LinearMode& mode : modes) longest_s = std::min(longest_s, LongestPeriod(mode));
  return longest_s;
}

double DecayRate(std::span<const LinearMode> modes, double period_s) {
  double slowest = kUnbounded;
  for (const LinearMode& mode : modes) slowest = std::min(slowest, Rate(mode, period_s));
  return slowest;
}

double SettlingTime(const LinearMode& mode, double period_s) {
  if (mode.order == 1) return std::ceil(std::log(1 / kSettled) / (Rate(mode, period_s) * period_s)) * period_s;
  const FromRest x(mode, period_s);
  double horizon = std::max(1.0, std::ceil(1 / (Rate(mode, period_s) * period_s)));
  while (x.Bound(horizon) > kSettled) horizon = std::ceil(horizon * 1.1);
  constexpr double kSteps = 4000;
  const double stride = std::max(1.0, std::floor(horizon / kSteps));
  double settled = horizon;
  while (settled > 0 && std::abs(x.At(settled - stride)) <= kSettled) settled -= stride;
  double unsettled = settled - stride;
  while (settled - unsettled > 1) {
    const double middle = std::floor((settled + unsettled) / 2);
    (std::abs(x.At(middle)) > kSettled ? unsettled : settled) = middle;
  }
  return settled * period_s;
}

double SettlingTime(std::span<const LinearMode> modes, double period_s) {
  const double slowest = DecayRate(modes, period_s);
  // From rest, a mode with rate r settles between 3.9 / r and 5.9 / r. Modes faster than 1.6 times the slowest cannot
  // be the last to settle.
  double settling_s = 0;
  for (const LinearMode& mode : modes) {
    if (Rate(mode, period_s) <= 1.6 * slowest) settling_s = std::max(settling_s, SettlingTime(mode, period_s));
  }
  return settling_s;
}

// With period h and the delay of m ticks, a root z = e^(i theta) of
//   (z - 1)^2 + z^-m (d h (z - 1) + k h^2 (1 + hold (z - 1))), or for order 1 of z - 1 + z^-m h k.
// In terms of w = (2 / h) tan(theta / 2), with e = d + (hold - 1/2) h k, the magnitudes and angles of both terms give
//   w^4 = (1 + h^2 w^2 / 4) |k + i w e|^2,  m theta = arg((k + i w e) (1 - i h w / 2)),
// or for order 1 2 sin(theta / 2) = h |k|, m theta = pi / 2 - |arg k| - theta / 2. w and theta may be negative: the
// modes of a directed graph are complex. As w grows without bound the loop gain must fall below 1.
std::optional<double> OwnDelayMargin(const LinearMode& mode, double period_s) {
  const Complex k = mode.stiffness, i(0, 1);
  const double h = period_s;
  if (mode.order == 1) {
    const double half_sine = h * std::abs(k) / 2;
    if (half_sine >= 1) return std::nullopt;
    const double theta = 2 * std::asin(half_sine);
    return h * WholeTicks((std::numbers::pi / 2 - std::abs(std::arg(k))) / theta - 0.5);
  }
  const Complex e = mode.damping + (mode.hold - 0.5) * h * k;
  const double highest = 1 - h * h * std::norm(e) / 4, turn = 2 * (k.real() * e.imag() - k.imag() * e.real());
  if (highest <= 0) return std::nullopt;
  // highest w^4 + h^2 / 4 turn w^3 - (|e|^2 + h^2 / 4 |k|^2) w^2 + turn w - |k|^2 = 0
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(4, 4);
  companion.diagonal<-1>().setOnes();
  companion.col(3) << std::norm(k), -turn, std::norm(e) + h * h / 4 * std::norm(k), -h * h / 4 * turn;
  companion.col(3) /= highest;
  double ticks = kUnbounded;
  for (const Complex root : Eigenvalues(companion)) {
    if (std::abs(root.imag()) > 1e-9 * std::abs(root)) continue;
    const double w = root.real(), theta = 2 * std::atan(h * std::abs(w) / 2);
    const double angle = std::arg((k + i * w * e) * (1.0 - i * h * w / 2.0));
    ticks = std::min(ticks, PositiveAngle(w > 0 ? angle : -angle) / theta);
  }
  return h * WholeTicks(ticks);
}

double WholeTicks(double ticks) {
  constexpr double kRounding = 1e-9;  // relative: at the margin itself the loop oscillates for ever
  return std::max(1.0, std::ceil(ticks * (1 - kRounding)));
}

}  // namespace mascot
