// Pairwise safety barrier certificates, each agent deciding its own command alone; Wang, Ames & Egerstedt, "Safety
// barrier certificates for collisions-free multirobot systems", IEEE Trans. Robotics 33 (2017); Borrmann, Wang, Ames &
// Egerstedt, ADHS 2015. With dp = p_i - p_j, dv = v_i - v_j along law.axes, d = |dp|, D = distance_m:
//   driven by velocity      h = d^2 - D^2                            h' = 2 dp.(u_i - u_j) >= -gamma h
//     share of agent i      dp.u_i >= -gamma h / 4
//   driven by acceleration  h = sqrt(2 (a_i + a_j)(d - D)) + dp.dv/d     h' >= -gamma h, which is -dp.(u_i - u_j) <= b,
//                           b = gamma h d + |dv|^2 - (dp.dv/d)^2 + (a_i + a_j) dp.dv / sqrt(2 (a_i + a_j)(d - D))
//     share of agent i      -dp.u_i <= a_i / (a_i + a_j) b
// a is control.max_acceleration_m_per_s2. Each agent takes the u_i nearest to what its law wants, within its limits.
// The paper has gamma h^3; with gamma h, one gain in 1/s serves both kinds, and h >= h(0) exp(-gamma t).
// Commands are held for a tick T. For that reason two terms differ from the paper:
// * b divides by the root, which is taken to be at least (a_i + a_j) T. Agents then come to rest at the end of the tick
//   in which they would reach D, and may come nearer than D by up to (a_i + a_j) T^2 / 8.
// * Let v_t be the part of dv across dp. Within a tick dp turns by |v_t| T / d, but commands turn with it only in the
//   next one. What this takes from h is at most 3/2 T |v_t| |u_i - u_j|, to first order in T: b is less by that.
// Closer than D, h = -sqrt(2 (a_i + a_j)(D - d)) + dp.dv/d: agents return to D.
#include "agent/safety.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace mascot {

double BrakingOf(const AgentConfig& agent) {
  return agent.traits().driven_by == Wanted::kAcceleration ? agent.control.max_acceleration_m_per_s2 : 0;
}

SafetyFilter::SafetyFilter(const Experiment& experiment, int id) : id_(id) {
  Adopt(experiment);
  halves_.reserve(2 * static_cast<std::size_t>(CountOf(Axes::kXyz)) + experiment.graph.HeardBy(id).size());
}

void SafetyFilter::Adopt(const Experiment& experiment) {
  experiment_ = &experiment;
  agent_ = &experiment.agent(id_);
}

HalfSpace SafetyFilter::ShareOfVelocity(const Eigen::Vector3d& dp_W) const {
  const SafetyConfig& safety = *agent_->law.safety;
  const double d = dp_W.norm();
  const double h = d * d - safety.distance_m * safety.distance_m;
  return {.n = dp_W / d, .b = -safety.gamma * h / (4 * d)};
}

HalfSpace SafetyFilter::ShareOfAcceleration(const Eigen::Vector3d& dp_W, const Eigen::Vector3d& dv_W,
                                            double a_j) const {
  const SafetyConfig& safety = *agent_->law.safety;
  const double T = experiment_->period_s(), a_i = BrakingOf(*agent_), a = a_i + a_j;
  const double d = dp_W.norm();
  const Eigen::Vector3d n_W = dp_W / d;
  const double opening = n_W.dot(dv_W);
  const double across = (dv_W - opening * n_W).norm();
  const double root = std::sqrt(2 * a * std::abs(d - safety.distance_m));
  const double h = std::copysign(root, d - safety.distance_m) + opening;
  const double turned = 1.5 * T * across * a * std::sqrt(CountOf(agent_->law.axes));
  const double b = safety.gamma * h * d + across * across + a * opening * d / std::max(root, a * T) - turned;
  return {.n = n_W, .b = -a_i / a * b / d};
}

HalfSpace SafetyFilter::Share(const Motion& self, const Heard& other) const {
  const Eigen::Vector3d dp_W = Along(agent_->law.axes, self.p_WB - other.motion.p_WB);
  if (dp_W.isZero(0)) return {};
  if (agent_->traits().driven_by == Wanted::kVelocity) return ShareOfVelocity(dp_W);
  const Eigen::Vector3d dv_W = Along(agent_->law.axes, self.v_WB - other.motion.v_WB);
  return ShareOfAcceleration(dp_W, dv_W, BrakingOf(experiment_->agent(other.id)));
}

SafetyFilter::Answer SafetyFilter::Nearest(const Eigen::Vector3d& wanted_W, double limit, const Motion& self,
                                           std::span<const Heard> heard) {
  assert(is_on());
  halves_.clear();
  for (int axis = 0; axis < CountOf(agent_->law.axes); ++axis)
    for (const double sign : {1.0, -1.0}) halves_.push_back({.n = sign * Eigen::Vector3d::Unit(axis), .b = -limit});
  const std::size_t limits = halves_.size();
  bool are_apart = true;
  for (const Heard& other : heard) {
    const HalfSpace share = Share(self, other);
    if (share.n.isZero(0))
      are_apart = false;
    else
      halves_.push_back(share);
  }
  const Eigen::Vector3d limited_W = wanted_W.cwiseMin(limit).cwiseMax(-limit);
  if (IsIn(halves_, limited_W)) return {.u_W = limited_W, .is_feasible = are_apart};  // exactly what it is without
  const MinViolation nearest = NearestWithin(halves_, limits, wanted_W);
  return {.u_W = nearest.u.cwiseMin(limit).cwiseMax(-limit), .is_feasible = are_apart && nearest.violation == 0};
}

}  // namespace mascot
