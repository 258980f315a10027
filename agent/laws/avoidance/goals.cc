#include "agent/laws/avoidance/goals.h"

#include <algorithm>

#include "agent/laws/avoidance/clearance_bound.h"

namespace mascot {
namespace {

constexpr double kAtGoal_m = 0.2;

}  // namespace

std::vector<Eigen::Vector3d> ReadGoals(const Experiment& experiment, Section& section) {
  std::vector<Eigen::Vector3d> goals_W = section.Points("goals_m");
  if (!section.Wrong("goals_m") && std::ssize(goals_W) != experiment.size())
    section.Fail("goals_m", "expected " + std::to_string(experiment.size()) + " goals, one per agent, got " +
                                std::to_string(goals_W.size()));
  return goals_W;
}

std::map<std::string, Value> GoToGoal(std::vector<Eigen::Vector3d> goals_W, int id, const Eigen::Vector3d& p_W) {
  goals_W[static_cast<std::size_t>(id - 1)] = p_W;
  Value::List goals;
  for (const Eigen::Vector3d& goal_W : goals_W)
    goals.push_back({Value::List{{goal_W.x()}, {goal_W.y()}, {goal_W.z()}}});
  return {{"goals_m", {goals}}};
}

GoalMeter::GoalMeter(const Experiment& experiment, std::span<const int> ids, GoalOf* goal_of)
    : experiment_(&experiment), ids_(ids.begin(), ids.end()), goal_of_(goal_of), arrived_s_(ids.size()) {}

void GoalMeter::Adopt(const Experiment& now) {
  for (std::size_t i = 0; i < ids_.size(); ++i)
    if (goal_of_(now.agent(ids_[i])) != goal_of_(experiment_->agent(ids_[i]))) arrived_s_[i].reset();
  experiment_ = &now;
}

void GoalMeter::Add(const TeamRow& row) {
  now_m_.reset();
  for (std::size_t i = 0; i < ids_.size(); ++i) {
    const AgentConfig& agent = experiment_->agent(ids_[i]);
    const Eigen::Vector3d& p_W = row.motions[static_cast<std::size_t>(agent.id - 1)].p_WB;
    if (const auto own_m = Clearance_m(agent, p_W, experiment_->physics.obstacles))
      now_m_ = std::min(now_m_.value_or(*own_m), *own_m);
    const double distance_m = Along(agent.law.axes, goal_of_(agent) - p_W).norm();
    if (!arrived_s_[i] && distance_m <= kAtGoal_m) arrived_s_[i] = experiment_->time_s(row.tick);
  }
  if (now_m_) clearance_m_ = std::min(*now_m_, clearance_m_.value_or(*now_m_));
}

std::vector<FigureValues> GoalMeter::Figures() const {
  std::optional<double> last_s = 0;
  for (const std::optional<double>& arrived_s : arrived_s_)
    last_s = arrived_s && last_s ? std::optional(std::max(*arrived_s, *last_s)) : std::nullopt;
  return {{clearance_m_}, {last_s}};
}

}  // namespace mascot
