#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace mascot {

/// The push of a body on an agent that passes it, as a wanted speed; Khatib (1986). `clearance` is the free distance
/// between the two (m). The push has the potential gain (1/clearance - 1/reach)^2 / 2, which grows beyond all bounds as
/// the clearance goes to 0.
struct Repulsion {
  double gain = 0;   ///< m^4/s
  double reach = 0;  ///< at this clearance and beyond there is no push (m)

  /// The wanted speed away from the body (m/s).
  double Push(double clearance) const {
    const double c = std::max(clearance, kTouching_m);
    return c < reach ? gain * (1 / c - 1 / reach) / (c * c) : 0;
  }
  /// How fast the push falls with the clearance (1/s); largest for the smallest clearance.
  double Steepness(double clearance) const {
    const double c = std::max(clearance, kTouching_m);
    return c < reach ? gain * (3 / c - 2 / reach) / (c * c * c) : 0;
  }

 private:
  static constexpr double kTouching_m = 1e-3;  // a smaller clearance counts as this one
};

/// `v`, or the vector of its direction whose length is `limit` if it is longer.
inline Eigen::Vector3d Limited(const Eigen::Vector3d& v, double limit) {
  const double length = v.norm();
  return length > limit ? (limit / length * v).eval() : v;
}

}  // namespace mascot
