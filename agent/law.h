#pragma once

#include <Eigen/Core>
#include <span>

#include "experiment/motion.h"

namespace mascot {

/// Numbers that a message may hold.
inline constexpr std::size_t kMaxMessage = 64;

/// What one agent heard from one neighbour.
struct Heard {
  int id = 0;
  double weight = 0;  ///< a_ij
  Motion motion = {};
  double age_s = 0;                      ///< since the neighbour was in this motion
  std::span<const double> message = {};  ///< what the neighbour's law sent last before that; empty: nothing
};

/// Decides where one agent wants to go, from what it alone has heard.
/// No clock, no I/O, no DDS: a law's answers depend only on what it was given, and on what it was given before.
class Law {
 public:
  virtual ~Law() = default;
  virtual Wanted wanted() const { return Wanted::kAcceleration; }
  /// Wanted acceleration (m/s^2) or velocity (m/s) of this agent, expressed in W. `t_s` is simulated time, increasing
  /// from call to call. `heard` has one entry per neighbour whose sample was delivered, in increasing id. What the law
  /// says along axes outside law.axes is ignored.
  virtual Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) = 0;
  /// What to send to those who hear this agent, after Want_W of the same tick; at most kMaxMessage numbers, valid until
  /// the next call; empty: nothing. Called only of laws that say (agent/laws.h) that they send messages.
  virtual std::span<const double> Message() { return {}; }
};

}  // namespace mascot
