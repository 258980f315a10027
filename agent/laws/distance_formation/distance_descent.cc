#include "agent/laws/distance_formation/distance_descent.h"

namespace mascot {

std::vector<Eigen::Vector3d> Descent(std::span<const Bar> bars, std::span<const Eigen::Vector3d> places,
                                     std::span<const Eigen::Vector3d> points, Axes axes) {
  std::vector<Eigen::Vector3d> descent(points.size(), Eigen::Vector3d::Zero());
  for (const Bar& bar : bars) {
    const Eigen::Vector3d z = SpanOf(bar, points, axes);
    const Eigen::Vector3d pull = bar.weight * (z.squaredNorm() - SquareOf(bar, places, axes)) * z;
    descent[static_cast<std::size_t>(bar.i - 1)] += pull;
    descent[static_cast<std::size_t>(bar.j - 1)] -= pull;
  }
  return descent;
}

}  // namespace mascot
