#include "orchestrator/crazyswarm/trajectory.h"

#include <algorithm>
#include <utility>

namespace mascot::crazyswarm {

Trajectory::Trajectory(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
  for (const Piece& piece : pieces_) duration_s_ += piece.duration_s;
}

Trajectory::Point Trajectory::At(double t_s) const {
  const bool rests = t_s < 0 || t_s > duration_s_;
  double t = std::clamp(t_s, 0.0, duration_s_);
  auto piece = pieces_.begin();
  for (; piece + 1 != pieces_.end() && t > piece->duration_s; ++piece) t -= piece->duration_s;
  Point point{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t k = kCoefficients; k > 0; --k) {  // Horner's scheme, with the first two derivatives
      point.a[axis] = point.a[axis] * t + 2 * point.v[axis];
      point.v[axis] = point.v[axis] * t + point.p[axis];
      point.p[axis] = point.p[axis] * t + piece->axes[static_cast<std::size_t>(axis)][k - 1];
    }
  if (rests) point.v = point.a = Eigen::Vector3d::Zero();
  return point;
}

}  // namespace mascot::crazyswarm
