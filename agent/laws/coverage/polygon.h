#pragma once

#include <Eigen/Core>
#include <vector>

namespace mascot {

/// The corners of a convex polygon, x and y in W (m), counterclockwise seen from above. A polygon with fewer than three
/// corners has no area. The functions below assume convexity, and do not check it.
using Polygon = std::vector<Eigen::Vector2d>;

/// The integrals of a density over a polygon, each divided by e^log_unit. `first` and `second` are about a point o; q
/// is the point of the integral. For the density 1: mass in m^2, first in m^3, second in m^4.
struct Moments {
  double mass = 0;                                  ///< the integral of the density
  Eigen::Vector2d first = Eigen::Vector2d::Zero();  ///< the integral of the density times q - o
  double second = 0;                                ///< the integral of the density times |q - o|^2
  double log_unit = 0;
};

/// The z component of a x b.
inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Whether the corners are those of a convex polygon of positive area, counterclockwise.
bool IsConvex(const Polygon& polygon);
/// The part of `polygon` on one side of the line through `through`: its points q have (q - through) . outward <= 0.
/// `outward` may have any length but 0. Without such a part the result has no corners.
Polygon Within(const Polygon& polygon, const Eigen::Vector2d& through, const Eigen::Vector2d& outward);
/// The part of `polygon` that is as close to `p` as to `other`, or closer: all of it, if `p` and `other` are equal.
Polygon Nearer(const Polygon& polygon, const Eigen::Vector2d& p, const Eigen::Vector2d& other);
/// The point of `polygon` that is nearest to `p`, which is `p` itself if `p` lies within. The polygon must have a
/// corner.
Eigen::Vector2d NearestPoint(const Polygon& polygon, const Eigen::Vector2d& p);
/// The moments of the density 1 over `polygon`, about `o`; log_unit is 0.
Moments MomentsOf(const Polygon& polygon, const Eigen::Vector2d& o);

}  // namespace mascot
