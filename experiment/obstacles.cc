#include "experiment/obstacles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

/// The nearest point along the obstacle's own axes, about its centre.
Eigen::Vector3d NearestPoint(const Obstacle& obstacle, const Eigen::Vector3d& p) {
  const Eigen::Vector3d half_m = obstacle.size_m / 2;
  Eigen::Vector3d nearest = p;
  switch (obstacle.shape) {
    case Shape::kBox:
      nearest = p.cwiseMin(half_m).cwiseMax(-half_m);
      break;
    case Shape::kSphere:
      if (const double l = p.norm(); l > half_m.x()) nearest *= half_m.x() / l;
      break;
    case Shape::kCylinder:
      if (const double l = p.head<2>().norm(); l > half_m.x()) nearest.head<2>() *= half_m.x() / l;
      nearest.z() = std::clamp(p.z(), -half_m.z(), half_m.z());
      break;
  }
  return nearest;
}

/// `v` without what is along `way` from the middle of a ball or disc, and as much slower as its surface, `radius_m`
/// from the middle, is nearer than the end of `way`.
template <typename Vector>
Vector AlongRound(const Vector& way, const Vector& v, double radius_m) {
  const double l = way.norm();
  if (l <= radius_m) return v;
  const Vector out = way / l;
  return radius_m / l * (v - out * out.dot(v));
}

/// How fast the nearest point moves along the obstacle's own axes: the derivative of NearestPoint().
Eigen::Vector3d VelocityOfNearest(const Obstacle& obstacle, const Eigen::Vector3d& p, const Eigen::Vector3d& v) {
  const Eigen::Vector3d half_m = obstacle.size_m / 2;
  const auto beyond = [&](int axis) { return std::abs(p[axis]) > half_m[axis]; };
  Eigen::Vector3d along = v;
  switch (obstacle.shape) {
    case Shape::kBox:
      for (int axis = 0; axis < 3; ++axis)
        if (beyond(axis)) along[axis] = 0;
      break;
    case Shape::kSphere:
      along = AlongRound(p, v, half_m.x());
      break;
    case Shape::kCylinder:
      along.head<2>() = AlongRound<Eigen::Vector2d>(p.head<2>(), v.head<2>(), half_m.x());
      if (beyond(2)) along.z() = 0;
      break;
  }
  return along;
}

}  // namespace

Eigen::Vector3d NearestPoint_W(const Obstacle& obstacle, const Eigen::Vector3d& p_W) {
  const Eigen::AngleAxisd to_W(obstacle.heading_rad, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d p = to_W.inverse() * (p_W - obstacle.p_W);
  const Eigen::Vector3d nearest = NearestPoint(obstacle, p);
  return nearest == p ? p_W : obstacle.p_W + to_W * nearest;
}

Eigen::Vector3d VelocityOfNearest_W(const Obstacle& obstacle, const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W) {
  const Eigen::AngleAxisd to_W(obstacle.heading_rad, Eigen::Vector3d::UnitZ());
  return to_W * VelocityOfNearest(obstacle, to_W.inverse() * (p_W - obstacle.p_W), to_W.inverse() * v_W);
}

// The distance to a convex body is convex along a line: a search that keeps the middle third or more finds its least.
double DistanceOfWay_m(const Obstacle& obstacle, const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W) {
  constexpr int kThirds = 100;  // (2/3)^100 of the way is 2.5e-18
  const auto distance_m = [&](double part) {
    const Eigen::Vector3d p_W = from_W + part * (to_W - from_W);
    return (NearestPoint_W(obstacle, p_W) - p_W).norm();
  };
  double low = 0, high = 1;
  for (int n = 0; n < kThirds; ++n) {
    const double third = (high - low) / 3;
    if (distance_m(low + third) <= distance_m(high - third))
      high -= third;
    else
      low += third;
  }
  return std::min({distance_m(0), distance_m(1), distance_m((low + high) / 2)});
}

// Points that are each the nearest to the last, on one obstacle and the other in turn, tend to the two that are nearest
// (Cheney & Goldstein 1959).
double Distance_m(const Obstacle& a, const Obstacle& b) {
  constexpr int kMaxTurns = 10000;
  constexpr double kClose_m = 1e-9;
  Eigen::Vector3d of_a_W = NearestPoint_W(a, b.p_W), of_b_W = NearestPoint_W(b, of_a_W);
  for (int n = 0; n < kMaxTurns; ++n) {
    const double before_m = (of_b_W - of_a_W).norm();
    of_a_W = NearestPoint_W(a, of_b_W);
    of_b_W = NearestPoint_W(b, of_a_W);
    if (before_m - (of_b_W - of_a_W).norm() < kClose_m) break;
  }
  return (of_b_W - of_a_W).norm();
}

}  // namespace mascot
