#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "agent/laws/law_figures.h"
#include "agent/laws/laws.h"

namespace mascot {

// Laws in which each agent has a goal of its own: the key goals_m.

inline constexpr Key kGoalsKey =
    key::Points("goals_m", {-1e6, 1e6}, "where each agent flies, one point per agent").Required().Live();

/// The goals, in W (m), by id - 1. Notes a mistake unless there is one for each agent.
std::vector<Eigen::Vector3d> ReadGoals(const Experiment& experiment, Section& section);
/// The parameters that make agent `id` fly to `p_W`, as LawEntry::go_to gives them. `goals_W`: all goals so far.
std::map<std::string, Value> GoToGoal(std::vector<Eigen::Vector3d> goals_W, int id, const Eigen::Vector3d& p_W);

/// The figures of a GoalMeter.
inline constexpr LawFigure kGoalFigures[] = {
    {.name = "clearance_m", .meaning = "smallest distance of the balls around the bodies to an obstacle"},
    {.name = "arrival_time_s",
     .meaning = "when the last agent was first within 0.2 m of its goal",
     .unpredicted = "nothing is promised about arrival"},
};

/// The curve of a GoalMeter.
inline constexpr LawCurve kGoalCurve = {.name = "clearance",
                                        .unit = "m",
                                        .meaning = "of the ball around a body to the nearest obstacle, the smallest",
                                        .decays = false,
                                        .figure = "clearance_m"};

/// Measures how near agents come to obstacles on the way to their goals, and when they arrive. If an event moves a
/// goal, its agent must reach it anew.
class GoalMeter final : public LawMeter {
 public:
  using GoalOf = const Eigen::Vector3d&(const AgentConfig& agent);
  GoalMeter(const Experiment& experiment, std::span<const int> ids, GoalOf* goal_of);
  void Adopt(const Experiment& now) override;
  void Add(const TeamRow& row) override;
  std::vector<FigureValues> Figures() const override;
  std::optional<double> Curve() const override { return now_m_; }

 private:
  const Experiment* experiment_;
  std::vector<int> ids_;
  GoalOf* goal_of_;                               // in W (m)
  std::vector<std::optional<double>> arrived_s_;  // by index in ids_
  std::optional<double> now_m_, clearance_m_;     // in the newest row, and the smallest of all
};

}  // namespace mascot
