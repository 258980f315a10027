#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/number_rows.h"

namespace mascot {

/// Position (m), velocity (m/s) and acceleration (m/s^2) of a reference at some time, in W.
struct PathPoint {
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero(), v_W = Eigen::Vector3d::Zero(), a_W = Eigen::Vector3d::Zero();
};

/// A way through samples (t, x, y, z), as a cubic spline: position, velocity and acceleration are continuous between
/// the first and the last sample. At these two the reference is at rest; before and after them it stays there.
class PathSamples {
 public:
  /// Reads text of lines "t,x,y,z" (s, m), of which the first may be a heading. Returns an empty text if it was read;
  /// else the mistake and, in `place`, where the mistake is.
  std::string Read(const std::string& text, TextPlace& place);
  PathPoint At(double t_s) const;
  /// Time from the first to the last sample. At least two samples must have been read.
  double duration_s() const { return knots_.back().t_s - knots_.front().t_s; }

 private:
  struct Knot {
    double t_s = 0;
    Eigen::Vector3d p_W, v_W = Eigen::Vector3d::Zero();
  };
  void FindVelocities();

  std::vector<Knot> knots_;
};

}  // namespace mascot
