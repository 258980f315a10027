#include "agent/laws/avoidance/clearance_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "agent/laws/avoidance/repulsion.h"
#include "agent/laws/parts/rounding.h"
#include "experiment/obstacles.h"

namespace mascot {
namespace {

/// The clearance at which an obstacle pushes with `speed`.
double Balance_m(const Repulsion& repulsion, double speed) {
  double low = 0, high = repulsion.reach;
  for (int n = 0; n < 200; ++n) {
    const double middle = (low + high) / 2;
    (repulsion.Push(middle) > speed ? low : high) = middle;
  }
  return low;
}

/// The least speed away from an obstacle that the law wants where the obstacle pushes with `push`.
double MinAway(double push, double speed) {
  if (push < speed) return push - speed;
  return std::min(push - speed, speed * std::sqrt(1 - speed * speed / (push * push)));
}

/// The least clearance of a body that approaches an obstacle from `start_m` away, with `speed` at first. The body's
/// velocity follows, at the rate `k` (1/s), what its law wanted one tick (`h`, in s) before.
double MinOfApproach_m(const Repulsion& repulsion, double start_m, double speed, double k, double h) {
  constexpr int kMaxSteps = 1'000'000;
  constexpr double kAtRest = 1e-6;  // m/s
  const double dt = std::min(0.01 / k, 1e-3 * repulsion.reach / speed);
  double c = start_m, y = speed;
  for (int n = 0; n < kMaxSteps && y > kAtRest && c > 0; ++n) {
    const double away = MinAway(repulsion.Push(c + speed * h), speed);
    c -= dt * std::clamp(y, 0.0, speed);     // the speed falls: that at the begin of a step takes too much
    y = (y - dt * k * away) / (1 + dt * k);  // and this leaves too much: exp(-x) < 1 / (1 + x)
  }
  return c;
}

std::string WhyNotOf(const AgentConfig& agent, double speed, double period_s) {
  const ControlConfig& control = agent.control;
  if (agent.traits().rolls || agent.traits().has_airframe)
    return "the bound is of bodies that go where they are wanted";
  if (agent.law.axes != Axes::kXyz) return "heights are held (law.axes), and the bound is of motion in space";
  if (agent.start_s > 0 || std::isfinite(agent.stop_s)) return "agents come or go";
  if (control.max_speed_m_per_s < speed) return "control.max_speed_m_per_s cuts what the law asks for";
  if (agent.traits().driven_by == Wanted::kVelocity) return "";
  if (agent.v_W.norm() > speed) return "agents start faster than law.speed_m_per_s";
  if (control.max_acceleration_m_per_s2 < 2 * control.velocity_gain * speed)
    return "control.max_acceleration_m_per_s2 may cut what the law asks for, up to twice control.velocity_gain times "
           "law.speed_m_per_s";
  return period_s * control.velocity_gain > 1 ? "the control period is longer than 1 / control.velocity_gain" : "";
}

}  // namespace

std::optional<double> Clearance_m(const AgentConfig& agent, const Eigen::Vector3d& p_W,
                                  const std::vector<Obstacle>& obstacles) {
  if (obstacles.empty()) return std::nullopt;
  double min_m = std::numeric_limits<double>::infinity();
  for (const Obstacle& obstacle : obstacles) min_m = std::min(min_m, (NearestPoint_W(obstacle, p_W) - p_W).norm());
  return min_m - agent.radius_m();
}

std::string ClearanceBound::WhyNot(const Experiment& experiment) const {
  const std::vector<Obstacle>& obstacles = experiment.physics.obstacles;
  if (obstacles.empty()) return "there are no obstacles, and of agents among each other theory says nothing";
  if (gain == 0) return "law.repulsion is 0";
  if (!experiment.sensors.own.IsNone() || experiment.sensors.own_delay_s > 0)
    return "what agents measure is noisy or late";
  for (std::size_t i = 0; i < obstacles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (Distance_m(obstacles[i], obstacles[j]) < 2 * influence_m)
        return "obstacles are less than twice law.influence_m apart: several push at once";
  for (const AgentConfig& agent : experiment.agents) {
    if (std::string why = WhyNotOf(agent, speed, experiment.period_s()); !why.empty()) return why;
    const Repulsion repulsion{.gain = gain, .reach = influence_m - agent.radius_m()};
    if (experiment.period_s() * repulsion.Steepness(Balance_m(repulsion, speed)) > 1)
      return "the control period is too long for a repulsion as steep as this";
  }
  return "";
}

PredictedFigure ClearanceBound::Predicted(const Experiment& experiment) const {
  double min_m = std::numeric_limits<double>::infinity();
  for (const AgentConfig& agent : experiment.agents) min_m = std::min(min_m, Least_m(experiment, agent));
  if (min_m <= 0) return NotPredicted("the bound is not above 0: an agent may touch an obstacle");
  return {.values = {min_m},
          .bound = Bound::kAtLeast,
          .magnitude = LargestStart_m(experiment) + speed * experiment.run.duration_s};
}

double ClearanceBound::Least_m(const Experiment& experiment, const AgentConfig& agent) const {
  const Repulsion repulsion{.gain = gain, .reach = influence_m - agent.radius_m()};
  const double start_m = Clearance_m(agent, agent.p_W, experiment.physics.obstacles).value_or(repulsion.reach);
  if (agent.traits().driven_by == Wanted::kVelocity) return std::min(start_m, Balance_m(repulsion, speed));
  return MinOfApproach_m(repulsion, std::min(start_m, repulsion.reach), speed, agent.control.velocity_gain,
                         experiment.period_s());
}

}  // namespace mascot
