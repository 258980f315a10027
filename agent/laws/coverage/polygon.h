#pragma once

#include <Eigen/Core>
#include <vector>

namespace mascot {

/// A convex polygon in the plane; corners counterclockwise. Fewer than three: it is empty.
using Polygon = std::vector<Eigen::Vector2d>;

/// Integrals of a density over a polygon, about the point o, in units of e^log_unit.
struct Moments {
  double mass = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();  ///< of q - o
  double second = 0;                                ///< of |q - o|^2
  double log_unit = 0;
};

/// a x b.
inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool IsConvex(const Polygon& polygon);
/// The part of `polygon` whose points q have (q - through) . outward <= 0.
Polygon Within(const Polygon& polygon, const Eigen::Vector2d& through, const Eigen::Vector2d& outward);
/// The part of `polygon` that is as close to `p` as to `other`, or closer.
Polygon Nearer(const Polygon& polygon, const Eigen::Vector2d& p, const Eigen::Vector2d& other);
/// The point of a polygon with at least one corner that is nearest to `p`: `p`, if that lies within.
Eigen::Vector2d NearestPoint(const Polygon& polygon, const Eigen::Vector2d& p);
/// The moments of the density 1, about `o`.
Moments MomentsOf(const Polygon& polygon, const Eigen::Vector2d& o);

}  // namespace mascot
