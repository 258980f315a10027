#pragma once

#include <array>
#include <span>
#include <utility>

namespace mascot {

/// Abscissa and weight of a rule of Gauss and Legendre on [-1, 1]; of two points that are mirrored, the positive one.
using GaussPoint = std::pair<double, double>;
inline constexpr std::array<GaussPoint, 3> kFivePoints = {{{0, 0.5688888888888888889},
                                                           {0.5384693101056830910, 0.4786286704993664680},
                                                           {0.9061798459386639928, 0.2369268850561890875}}};
inline constexpr std::array<GaussPoint, 5> kTenPoints = {{{0.1488743389816312109, 0.2955242247147528702},
                                                          {0.4333953941292471908, 0.2692667193099963551},
                                                          {0.6794095682990244062, 0.2190863625159820440},
                                                          {0.8650633666889845107, 0.1494513491505805931},
                                                          {0.9739065285171717201, 0.0666713443086881376}}};

/// Calls visit(x, weight) for the points of a rule on [from, to]: the integral is the sum of weight f(x).
template <class Visit>
void ForEachGaussPoint(std::span<const GaussPoint> rule, double from, double to, const Visit& visit) {
  const double middle = (from + to) / 2, half = (to - from) / 2;
  for (const auto& [share, weight] : rule) {
    visit(middle + share * half, weight * half);
    if (share > 0) visit(middle - share * half, weight * half);
  }
}

}  // namespace mascot
