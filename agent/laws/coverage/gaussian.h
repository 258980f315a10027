#pragma once

#include <array>
#include <span>

#include "agent/laws/parts/gauss_points.h"

namespace mascot {

/// Points for the integral of a polynomial of low degree times a Gaussian of width 1, over at most kLongestPanel.
inline constexpr double kLongestPanel = 2;
std::span<const GaussPoint> GaussRuleFor(double length);

/// The integrals of (y - o)^k e^(-y^2 / 2), k = 0, 1, 2, from `low` to `high`.
std::array<double, 3> GaussMoments(double low, double high, double o);

}  // namespace mascot
