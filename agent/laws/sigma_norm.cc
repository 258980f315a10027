#include "agent/laws/sigma_norm.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

namespace mascot {
namespace {

constexpr int kKnots = 64;

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
      till_range_(kKnots + 1, 0) {
  for (std::size_t n = kKnots; n-- > 0;) {
    const double s = static_cast<double>(n) * r_alpha_ / kKnots;
    till_range_[n] = till_range_[n + 1] + ByQuadrature(s, s + r_alpha_ / kKnots);
  }
}

double AlphaPair::Action(double s) const {
  const double off = s - d_alpha_;
  return Rho(s / r_alpha_, bump_) * off / std::sqrt(1 + off * off);
}

double AlphaPair::TillRange(double s) const {
  if (!(s < r_alpha_)) return 0;  // nor for what is no number
  const auto next = std::min(static_cast<std::size_t>(s / r_alpha_ * kKnots) + 1, std::size_t{kKnots});
  return ByQuadrature(s, static_cast<double>(next) * r_alpha_ / kKnots) + till_range_[next];
}

double AlphaPair::ByQuadrature(double from, double to) const {  // Gauss and Legendre's, of degree 9
  constexpr std::array kNodes = {std::pair{0.0, 0.5688888888888889}, std::pair{0.5384693101056831, 0.4786286704993665},
                                 std::pair{0.9061798459386640, 0.2369268850561891}};
  const double middle = (from + to) / 2, half = (to - from) / 2;
  double sum = kNodes[0].second * Action(middle);
  for (std::size_t n = 1; n < kNodes.size(); ++n)
    for (const double side : {-half, half}) sum += kNodes[n].second * Action(middle + side * kNodes[n].first);
  return half * sum;
}

double AlphaPair::LargestCurvature() const {
  constexpr int kSteps = 2000;
  const double step_m = range_m_ / kSteps;
  double largest = 0, before = 0;
  for (int n = 0; n < kSteps; ++n) {
    const double l = (n + 1) * step_m, pull = Stiffness(l) * l;
    // Along the pair and across it; the margin is for what lies between the steps.
    largest = std::max({largest, 1.01 * std::abs(pull - before) / step_m, std::abs(Stiffness(n * step_m))});
    before = pull;
  }
  return largest;
}

}  // namespace mascot
