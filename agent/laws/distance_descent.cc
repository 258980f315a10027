#include "agent/laws/distance_descent.h"

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

/// 4 V.
double FourV(std::span<const Bar> bars, std::span<const Eigen::Vector3d> places,
             std::span<const Eigen::Vector3d> points, Axes axes) {
  double sum = 0;
  for (const Bar& bar : bars)
    sum += bar.weight * std::pow(SquareOf(bar, points, axes) - SquareOf(bar, places, axes), 2);
  return sum;
}

}  // namespace

double LargestErrorBelow(std::span<const Bar> bars, std::span<const Eigen::Vector3d> places,
                         std::span<const Eigen::Vector3d> points, Axes axes) {
  const double v4 = FourV(bars, places, points, axes);
  double largest_m = 0;
  for (const Bar& bar : bars)
    largest_m = std::max(largest_m, std::sqrt(v4 / (bar.weight * SquareOf(bar, places, axes))));
  return largest_m;
}

bool PotentialNeverGrows(std::span<const Bar> bars, std::span<const Eigen::Vector3d> places,
                         std::span<const Eigen::Vector3d> points, Axes axes, double step) {
  const double v4 = FourV(bars, places, points, axes);
  Eigen::VectorXd curvatures = Eigen::VectorXd::Zero(std::ssize(points));  // by id - 1
  for (const Bar& bar : bars) {
    // |z|^2 - d^2 is at most sqrt(4 V / weight).
    const double of_bar = bar.weight * 2 * SquareOf(bar, places, axes) + 3 * std::sqrt(bar.weight * v4);
    curvatures(bar.i - 1) += of_bar;
    curvatures(bar.j - 1) += of_bar;
  }
  return step * 2 * curvatures.maxCoeff() <= 2;
}

double ErrorOfTwo(const Bar& bar, std::span<const Eigen::Vector3d> places, std::span<const Eigen::Vector3d> points,
                  Axes axes, double step, std::int64_t ticks) {
  const double d2 = SquareOf(bar, places, axes);
  double z_m = LengthOf(bar, points, axes);
  for (std::int64_t k = 0; k < ticks; ++k) z_m -= 2 * step * bar.weight * (z_m * z_m - d2) * z_m;
  return std::abs(std::abs(z_m) - std::sqrt(d2));
}

}  // namespace mascot
