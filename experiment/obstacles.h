#pragma once

#include <Eigen/Core>

#include "experiment/physics.h"

namespace mascot {

// Points and distances of obstacles: distances in m, points in W (m).

/// The point of `obstacle` that is nearest to `p_W`; inside of it, `p_W` itself.
Eigen::Vector3d NearestPoint_W(const Obstacle& obstacle, const Eigen::Vector3d& p_W);
/// The velocity (m/s, in W) at which NearestPoint_W() moves along the obstacle while `p_W` moves with `v_W` (m/s);
/// inside the obstacle it is `v_W`. At an edge of a face, where the point would turn round the edge, it moves as on
/// that face.
Eigen::Vector3d VelocityOfNearest_W(const Obstacle& obstacle, const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W);
/// The smallest distance between the straight way from `from_W` to `to_W` and `obstacle`; 0: they meet.
double DistanceOfWay_m(const Obstacle& obstacle, const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W);
/// The distance between two obstacles; 0: they meet.
double Distance_m(const Obstacle& a, const Obstacle& b);

}  // namespace mascot
