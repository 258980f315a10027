#pragma once

#include <Eigen/Core>
#include <span>

#include "experiment/motion.h"

namespace mascot {

/// What one agent heard from one neighbour.
struct Heard {
  int id = 0;
  double weight = 0;  ///< a_ij
  Motion motion;
};

/// Decides where one agent wants to go, from what it alone has heard.
/// No clock, no I/O, no DDS: a law's answers depend only on what it was given, and on what it was given before.
class Law {
 public:
  virtual ~Law() = default;
  /// Wanted acceleration of this agent, expressed in W (m/s^2). `t_s` is simulated time, increasing from
  /// call to call. `heard` has one entry per neighbour whose sample was delivered, in increasing id. What
  /// the law says along axes outside law.axes is ignored.
  virtual Eigen::Vector3d Accel_W(double t_s, const Motion& self, std::span<const Heard> heard) = 0;
};

}  // namespace mascot
