#include "agent/laws/coverage/gaussian.h"

#include <cmath>
#include <numbers>

namespace mascot {

std::span<const GaussPoint> GaussRuleFor(double length) {
  constexpr double kShort = 0.3;  // the terms that five points leave out are below 1e-15 there
  if (length <= kShort) return kFivePoints;
  return kTenPoints;
}

std::array<double, 3> GaussMoments(double low, double high, double o) {
  std::array<double, 3> sums{};
  if (high - low <= kLongestPanel) {
    ForEachGaussPoint(GaussRuleFor(high - low), low, high, [&](double y, double weight) {
      const double part = weight * std::exp(-y * y / 2);
      sums[0] += part;
      sums[1] += part * (y - o);
      sums[2] += part * (y - o) * (y - o);
    });
    return sums;
  }
  constexpr double kRoot = std::numbers::sqrt2 / 2;
  const double scale = std::sqrt(std::numbers::pi / 2), e_low = std::exp(-low * low / 2),
               e_high = std::exp(-high * high / 2);
  if (low > 0)
    sums[0] = scale * (std::erfc(low * kRoot) - std::erfc(high * kRoot));
  else if (high < 0)
    sums[0] = scale * (std::erfc(-high * kRoot) - std::erfc(-low * kRoot));
  else
    sums[0] = scale * (std::erf(high * kRoot) - std::erf(low * kRoot));
  const double first = e_low - e_high, second = sums[0] + low * e_low - high * e_high;  // about 0
  sums[1] = first - o * sums[0];
  sums[2] = second - 2 * o * first + o * o * sums[0];
  return sums;
}

}  // namespace mascot
