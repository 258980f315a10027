#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace mascot::crazyswarm {

/// A motion along polynomials of time, one piece after the other, as a Crazyflie keeps it.
class Trajectory {
 public:
  static constexpr std::size_t kCoefficients = 8;  ///< of a piece and axis, from that of t^0 on
  struct Piece {
    std::array<std::array<double, kCoefficients>, 3> axes = {};  ///< x, y, z (m)
    double duration_s = 0;
  };
  struct Point {
    Eigen::Vector3d p, v, a;
  };

  Trajectory() = default;
  explicit Trajectory(std::vector<Piece> pieces);

  bool empty() const { return pieces_.empty(); }
  double duration_s() const { return duration_s_; }
  /// Where it is at `t_s` after its beginning; before that and after its end it rests there.
  Point At(double t_s) const;

 private:
  std::vector<Piece> pieces_;
  double duration_s_ = 0;
};

}  // namespace mascot::crazyswarm
