#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "agent/laws/law.h"
#include "agent/safety_qp.h"
#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// The safety filter of one agent ([law.safety]): changes what its law wants as little as is needed to stay away from
/// the agents that it hears. Each agent keeps its own share of the constraint of a pair; the pair is safe if both
/// agents do.
class SafetyFilter {
 public:
  SafetyFilter(const Experiment& experiment, int id);
  /// From now on bounds and gains are those of `experiment`, which must outlive this object or the next Adopt().
  void Adopt(const Experiment& experiment);
  bool is_on() const { return agent_->law.safety.has_value(); }

  struct Answer {
    Eigen::Vector3d u_W = Eigen::Vector3d::Zero();
    bool is_feasible = true;  ///< false: no command within the limit is safe, and u_W is the least unsafe one
  };
  /// The velocity (m/s) or acceleration (m/s^2), whichever drives the agent's model, that is nearest to `wanted_W`
  /// among those that are safe and at most `limit` along each axis, in W. The filter must be on.
  Answer Nearest(const Eigen::Vector3d& wanted_W, double limit, const Motion& self, std::span<const Heard> heard);

 private:
  /// The commands that keep this agent's share of the constraint of the pair with `other`; no normal if both are at the
  /// same place.
  HalfSpace Share(const Motion& self, const Heard& other) const;
  HalfSpace ShareOfVelocity(const Eigen::Vector3d& dp_W) const;
  HalfSpace ShareOfAcceleration(const Eigen::Vector3d& dp_W, const Eigen::Vector3d& dv_W, double a_j) const;

  const Experiment* experiment_;
  const AgentConfig* agent_;
  int id_;
  std::vector<HalfSpace> halves_;  // the limits, then the shares; grows only while more agents are heard than before
};

/// The bound on the acceleration of an agent on which other agents count (m/s^2): 0 for a model driven by velocity,
/// whose acceleration says nothing.
double BrakingOf(const AgentConfig& agent);

}  // namespace mascot
