#include "agent/laws/flocking/sigma_norm.h"

#include <algorithm>
#include <numbers>

#include "agent/laws/parts/gauss_points.h"

namespace mascot {
namespace {

constexpr int kKnots = 64;

/// sqrt(1 + off^2) - 1: the integral of the paper's phi, from 0.
double WithoutFading(double off) { return off * off / (std::sqrt(1 + off * off) + 1); }

}  // namespace

double Rho(double share, double from) {
  if (share < from) return 1;
  if (share >= 1) return 0;
  return (1 + std::cos(std::numbers::pi * (share - from) / (1 - from))) / 2;
}

AlphaPair::AlphaPair(double distance_m, double range_m, double epsilon, double bump)
    : range_m_(range_m),
      epsilon_(epsilon),
      bump_(bump),
      r_alpha_(SigmaNorm(range_m, epsilon)),
      d_alpha_(SigmaNorm(distance_m, epsilon)),
      first_knot_(std::asinh(bump * r_alpha_ - d_alpha_)),
      knot_step_((std::asinh(r_alpha_ - d_alpha_) - first_knot_) / kKnots),
      till_range_(kKnots + 1, 0) {
  for (std::size_t n = kKnots; n > 0; --n) till_range_[n - 1] = till_range_[n] + Fading(Knot(n - 1), Knot(n));
}

double AlphaPair::Action(double s) const {
  const double off = s - d_alpha_;
  return Rho(s / r_alpha_, bump_) * off / std::sqrt(1 + off * off);
}

// Where agents fade, s = d_alpha + sinh(v): the integral of rho sinh(v) over v has nothing sharp in it, however sharp
// phi is at the distance.
double AlphaPair::TillRange(double s) const {
  if (!(s < r_alpha_)) return 0;  // nor for what is no number
  const double off = s - d_alpha_, fades = bump_ * r_alpha_ - d_alpha_;
  if (off < fades) return WithoutFading(fades) - WithoutFading(off) + till_range_[0];
  const double v = std::asinh(off);
  const auto next =
      std::clamp(static_cast<std::size_t>((v - first_knot_) / knot_step_) + 1, std::size_t{1}, std::size_t{kKnots});
  return Fading(v, Knot(next)) + till_range_[next];
}

double AlphaPair::Fading(double from, double to) const {
  double sum = 0;
  ForEachGaussPoint(kTenPoints, from, to, [&](double v, double weight) {
    const double off = std::sinh(v);
    sum += weight * Rho((d_alpha_ + off) / r_alpha_, bump_) * off;
  });
  return sum;
}

// The pull is U' = rho(s) phi(s) w, w = l / sqrt(1 + epsilon l^2) = ds/dl. Along the pair the curvature is U'' = (rho'
// phi + rho phi') w^2 + rho phi / sqrt(1 + epsilon l^2)^3, across it U' / l. Over a step each factor is bounded.
double AlphaPair::LargestCurvature() const {
  constexpr int kSteps = 2000;
  // Steps are short near the distance, where phi turns from -1 to 1 within 1 of s.
  const double first = std::asinh(-d_alpha_), last = std::asinh(r_alpha_ - d_alpha_);
  double largest = 0;
  for (int n = 0; n < kSteps; ++n) {
    const double off_a = std::sinh(first + (last - first) * n / kSteps),
                 off_b = std::sinh(first + (last - first) * (n + 1) / kSteps);
    largest = std::max(largest, CurvatureBetween(std::max(0.0, d_alpha_ + off_a), d_alpha_ + off_b));
  }
  return largest;
}

double AlphaPair::SteepestFading(double share_a, double share_b) const {
  const double a = std::clamp((share_a - bump_) / (1 - bump_), 0.0, 1.0), b = (share_b - bump_) / (1 - bump_);
  if (b <= 0) return 0;
  const bool middle = a <= 0.5 && b >= 0.5;
  const double sine =
      middle ? 1 : std::max(std::sin(std::numbers::pi * a), std::sin(std::numbers::pi * std::min(b, 1.0)));
  return std::numbers::pi / (2 * (1 - bump_)) * sine;
}

double AlphaPair::CurvatureBetween(double s_a, double s_b) const {
  const auto phi = [](double off) { return off / std::sqrt(1 + off * off); };
  const auto root = [&](double s) { return 1 + epsilon_ * s; };  // sqrt(1 + epsilon l^2)
  const double off_a = s_a - d_alpha_, off_b = s_b - d_alpha_;
  const double nearest = off_a > 0 ? off_a : off_b < 0 ? off_b : 0;
  const double rho = Rho(s_a / r_alpha_, bump_), steepest = 1 / std::pow(1 + nearest * nearest, 1.5);
  const double fade = SteepestFading(s_a / r_alpha_, s_b / r_alpha_) / r_alpha_;
  const double w2 = s_b * (2 + epsilon_ * s_b) / (root(s_b) * root(s_b));
  const double pull = std::max(0.0, phi(off_b)), push = std::max(0.0, -phi(off_a));
  const double most = w2 * (fade * push + rho * steepest) + rho * pull / std::pow(root(s_a), 3);
  const double least = w2 * fade * pull + rho * push / std::pow(root(s_a), 3);
  return std::max({most, least, rho * std::max(pull, push) / root(s_a)});
}

}  // namespace mascot
