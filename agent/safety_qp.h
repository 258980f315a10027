#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace mascot {

/// The half-space n.u >= b, of unit normal n.
struct HalfSpace {
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  double b = 0;
};

/// Whether `u` is in all of `halves`, to about 1e-10 of the numbers in them.
bool IsIn(std::span<const HalfSpace> halves, const Eigen::Vector3d& u);

/// The point nearest to `wanted` that is in all of `halves`; absent: they have no point in common. It is found by the
/// dual active-set method of Goldfarb & Idnani (1983) for min |u - wanted|^2, to about 1e-9 of the numbers in it,
/// without allocating memory. If all normals and `wanted` lie in a plane, so does the result.
std::optional<Eigen::Vector3d> NearestIn(std::span<const HalfSpace> halves, const Eigen::Vector3d& wanted);

/// The result of NearestIn(), if there is one. Otherwise all half-spaces but the first `kept` are made wider by the
/// same distance, the smallest with which all have a point in common (the least violation), and the result is the point
/// nearest to `wanted` in them. The first `kept` must have a point in common.
struct MinViolation {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();
  double violation = 0;  ///< distance by which the half-spaces were made wider; 0: none was needed
};
MinViolation NearestWithin(std::span<const HalfSpace> halves, std::size_t kept, const Eigen::Vector3d& wanted);

}  // namespace mascot
