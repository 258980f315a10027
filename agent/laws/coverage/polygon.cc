#include "agent/laws/coverage/polygon.h"

#include <algorithm>

namespace mascot {

bool IsConvex(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  double area = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % n], &c = polygon[(i + 2) % n];
    if (Cross(b - a, c - b) < 0) return false;
    for (std::size_t k = 2; k < n; ++k)
      if (Cross(b - a, polygon[(i + k) % n] - a) < 0) return false;
    area += Cross(a, b) / 2;
  }
  return n >= 3 && area > 0;
}

Polygon Within(const Polygon& polygon, const Eigen::Vector2d& through, const Eigen::Vector2d& outward) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double beyond_a = (a - through).dot(outward), beyond_b = (b - through).dot(outward);
    if (beyond_a <= 0) part.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0))
      part.emplace_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
  }
  return part;
}

Polygon Nearer(const Polygon& polygon, const Eigen::Vector2d& p, const Eigen::Vector2d& other) {
  const Eigen::Vector2d way = other - p, middle = (p + other) / 2;
  return way.isZero(0) ? polygon : Within(polygon, middle, way);
}

Eigen::Vector2d NearestPoint(const Polygon& polygon, const Eigen::Vector2d& p) {
  bool inside = polygon.size() >= 3;
  Eigen::Vector2d nearest = polygon.front();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], edge = polygon[(i + 1) % polygon.size()] - a;
    if (edge.isZero(0)) continue;
    inside = inside && Cross(edge, p - a) >= 0;
    const Eigen::Vector2d q = a + std::clamp(edge.dot(p - a) / edge.squaredNorm(), 0.0, 1.0) * edge;
    if ((q - p).squaredNorm() < (nearest - p).squaredNorm()) nearest = q;
  }
  return inside ? p : nearest;
}

Moments MomentsOf(const Polygon& polygon, const Eigen::Vector2d& o) {
  Moments moments;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - o, b = polygon[(i + 1) % polygon.size()] - o;
    moments.mass += Cross(a, b) / 2;
    moments.first += Cross(a, b) * (a + b) / 6;
    moments.second += Cross(a, b) * (a.squaredNorm() + a.dot(b) + b.squaredNorm()) / 12;
  }
  return moments;
}

}  // namespace mascot
