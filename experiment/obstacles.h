#pragma once

#include <Eigen/Core>

#include "experiment/physics.h"

namespace mascot {

// Where obstacles are, as bodies see them: distances in m, points in W (m).

/// The point of `obstacle` that is nearest to `p_W`; inside of it, `p_W` itself.
Eigen::Vector3d NearestPoint_W(const Obstacle& obstacle, const Eigen::Vector3d& p_W);
/// How fast that point moves along the obstacle as `p_W` moves by `v_W` (m/s); inside of it, as `p_W` does. At an
/// edge of a face, where it turns round the edge, it moves as on that face.
Eigen::Vector3d VelocityOfNearest_W(const Obstacle& obstacle, const Eigen::Vector3d& p_W, const Eigen::Vector3d& v_W);
/// How near the straight way from `from_W` to `to_W` comes to `obstacle`; 0: it meets it.
double DistanceOfWay_m(const Obstacle& obstacle, const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W);
/// The distance between two obstacles; 0: they meet.
double Distance_m(const Obstacle& a, const Obstacle& b);

}  // namespace mascot
