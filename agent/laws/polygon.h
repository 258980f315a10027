#pragma once

#include <Eigen/Core>
#include <vector>

namespace mascot {

/// A convex polygon in the plane; corners counterclockwise. Fewer than three: it is empty.
using Polygon = std::vector<Eigen::Vector2d>;

/// A Gaussian bump of a density.
struct Bump {
  Eigen::Vector2d centre_m;
  double width_m = 1, weight = 1;
};

/// Integrals of a density over a polygon, about the point o.
struct Moments {
  double mass = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();  ///< of q - o
  double second = 0;                                ///< of |q - o|^2
};

bool IsConvex(const Polygon& polygon);
/// The part of `polygon` that is as close to `p` as to `other`, or closer.
Polygon Nearer(const Polygon& polygon, const Eigen::Vector2d& p, const Eigen::Vector2d& other);
/// About `o`. Without bumps the density is 1, and the integrals are exact; else it is the sum of the bumps, and they
/// are sums over points that are exact for polynomials of degree 5 in each of 4 parts of each triangle.
Moments MomentsOf(const Polygon& polygon, const Eigen::Vector2d& o, const std::vector<Bump>& bumps);

}  // namespace mascot
