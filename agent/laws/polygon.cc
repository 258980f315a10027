#include "agent/laws/polygon.h"

#include <array>
#include <cmath>

namespace mascot {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double DensityAt(const Eigen::Vector2d& q, const std::vector<Bump>& bumps) {
  double density = 0;
  for (const Bump& bump : bumps)
    density += bump.weight * std::exp(-(q - bump.centre_m).squaredNorm() / (2 * bump.width_m * bump.width_m));
  return density;
}

/// Adds the integrals over a triangle, by the seven points of Radon (1948).
void AddTriangle(const std::array<Eigen::Vector2d, 3>& corners, const Eigen::Vector2d& o,
                 const std::vector<Bump>& bumps, Moments& moments) {
  const double area = Cross(corners[1] - corners[0], corners[2] - corners[0]) / 2, root = std::sqrt(15.0);
  const auto add = [&](double weight, double a, double b, double c) {
    const Eigen::Vector2d q = a * corners[0] + b * corners[1] + c * corners[2];
    const double part = weight * area * DensityAt(q, bumps);
    moments.mass += part;
    moments.first += part * (q - o);
    moments.second += part * (q - o).squaredNorm();
  };
  add(9.0 / 40, 1.0 / 3, 1.0 / 3, 1.0 / 3);
  for (const double sign : {-1.0, 1.0}) {
    const double weight = (155 + sign * root) / 1200, near = (6 + sign * root) / 21, far = 1 - 2 * near;
    add(weight, far, near, near);
    add(weight, near, far, near);
    add(weight, near, near, far);
  }
}

}  // namespace

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

Polygon Nearer(const Polygon& polygon, const Eigen::Vector2d& p, const Eigen::Vector2d& other) {
  const Eigen::Vector2d way = other - p, middle = (p + other) / 2;
  if (way.isZero(0)) return polygon;
  Polygon part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double beyond_a = (a - middle).dot(way), beyond_b = (b - middle).dot(way);
    if (beyond_a <= 0) part.push_back(a);
    if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0))
      part.emplace_back(a + beyond_a / (beyond_a - beyond_b) * (b - a));
  }
  return part;
}

Moments MomentsOf(const Polygon& polygon, const Eigen::Vector2d& o, const std::vector<Bump>& bumps) {
  Moments moments;
  for (std::size_t i = 0; bumps.empty() && i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - o, b = polygon[(i + 1) % polygon.size()] - o;
    moments.mass += Cross(a, b) / 2;
    moments.first += Cross(a, b) * (a + b) / 6;
    moments.second += Cross(a, b) * (a.squaredNorm() + a.dot(b) + b.squaredNorm()) / 12;
  }
  for (std::size_t i = 1; !bumps.empty() && i + 1 < polygon.size(); ++i) {
    const Eigen::Vector2d &a = polygon[0], &b = polygon[i], &c = polygon[i + 1];
    const Eigen::Vector2d ab = (a + b) / 2, bc = (b + c) / 2, ca = (c + a) / 2;
    AddTriangle({a, ab, ca}, o, bumps, moments);
    AddTriangle({ab, b, bc}, o, bumps, moments);
    AddTriangle({ca, bc, c}, o, bumps, moments);
    AddTriangle({ab, bc, ca}, o, bumps, moments);
  }
  return moments;
}

}  // namespace mascot
