#pragma once

#include <Eigen/Core>

#include "base/motion.h"
#include "physics_server/clearance.h"
#include "physics_server/model.h"

namespace mascot {

/// What of a body bounds its way.
struct SweptBody {
  double mass_kg = 0;
  double min_inertia_kg_m2 = 0, max_inertia_kg_m2 = 0;    ///< of its principal moments
  Eigen::Vector3d half_size_m = Eigen::Vector3d::Zero();  ///< of its box about x, y, z of B
  double radius_m = 0;                                    ///< of a sphere about its centre that it does not leave
  double gravity_m_per_s2 = 0;                            ///< that it feels
  double reach_m = 0;                                     ///< how far from its surface Bullet makes contact points
};

/// `reach_m`: how far from the body's surface Bullet makes contact points.
SweptBody MakeSweptBody(const Model& model, double gravity_m_per_s2, double reach_m);

/// An upright box that the body, with its reach, does not leave within `time_s` if it touches nothing: `state` is its
/// motion now, and `limit` what its model does to it at most, in wind of at most `wind_m_per_s`. Unlimited if no such
/// box can be told.
Clearance::Box SweptBox(const Motion& state, const SweptBody& body, const PushLimit& limit, double wind_m_per_s,
                        double time_s);

}  // namespace mascot
