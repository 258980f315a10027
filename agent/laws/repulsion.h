#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace mascot {

/// The repulsion of Khatib (1986) from a body that is `clearance` away, as a speed. Its potential,
/// gain (1/clearance - 1/reach)^2 / 2, grows beyond all bounds as the clearance goes to 0.
struct Repulsion {
  double gain = 0;   ///< m^4/s
  double reach = 0;  ///< from this clearance on there is none (m)

  /// Away from the body (m/s).
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
  static constexpr double kTouching_m = 1e-3;  // from there on the push no longer grows
};

/// `v`, or the vector of its direction whose length is `limit` if it is longer.
inline Eigen::Vector3d Limited(const Eigen::Vector3d& v, double limit) {
  const double length = v.norm();
  return length > limit ? (limit / length * v).eval() : v;
}

}  // namespace mascot
