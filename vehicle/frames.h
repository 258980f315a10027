#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "base/motion.h"

namespace mascot {

// Between our frames and those of aircraft, in one place.
//
// Ours: W is the world (x east, y north, z up: ENU), B the body (x forward, y left, z up: FLU).
// Theirs: N is the world (x north, y east, z down: NED), F the body (x forward, y right, z down: FRD).
// Yaw is the angle of the body's x axis: ours from east, towards north; theirs from north, towards east.
// Sources: ROS REP 103 and REP 147.

/// A vector of components in W as components in N. Its own inverse: also of components in N as components in W.
Eigen::Vector3d SwapWorldAxes(const Eigen::Vector3d& vector);
/// A vector of components in B as components in F, and of components in F as components in B.
Eigen::Vector3d SwapBodyAxes(const Eigen::Vector3d& vector);
/// The orientation of B in W (components in B to those in W) as that of F in N, and that of F in N as that of B in W.
Eigen::Quaterniond SwapOrientation(const Eigen::Quaterniond& q);
/// Our yaw as theirs, and theirs as ours (rad); in [-pi, pi].
double SwapYaw(double yaw_rad);

/// The local frame L of a vehicle, in which its estimator says where it is: upright, as W is, with an origin and a
/// heading of its own. Vehicles that compare with the north have yaw 0.
struct LocalFrame {
  Eigen::Vector3d p_WL = Eigen::Vector3d::Zero();  ///< the origin (m)
  double yaw_WL = 0;                               ///< of L's x axis from W's, towards W's y axis (rad)

  /// A motion whose components in the world are those in L, with components in W, and back. a_WB is a vector as v_WB
  /// is.
  Motion ToWorld(const Motion& in_L) const;
  Motion FromWorld(const Motion& in_W) const;
};

}  // namespace mascot
