#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"

namespace mascot {

// Teams in which several agents lead, and the places of the other agents follow from those of the leaders.

/// Above this many agents the matrices below would be too large: theory is silent, and nothing is measured.
inline constexpr int kMaxAgentsOfMatrices = 1000;

inline constexpr Key kLeadersKey =
    key::Numbers("leaders", {1, kMaxAgents}, "agents that lead: they use nothing of what they hear").Required();

/// A team and its leaders. Ids are in increasing order.
struct LedTeam {
  LedTeam(std::vector<int> leader_ids, int agents);
  bool IsLeader(int id) const;

  std::vector<int> leaders, followers;
};

/// Drawing::hull for a law whose parameters have a `team`.
template <class Params>
inline constexpr DrawnKey<int> kHullOfLeaders = {
    kLeadersKey.name, [](const LawConfig& law) -> std::span<const int> { return ParamsOf<Params>(law).team.leaders; }};

/// Reads law.leaders. At least one agent is left to follow, or a mistake is noted in `section`.
std::vector<int> ReadLeaders(const Experiment& experiment, Section& section);

/// The entries of `matrix` (N x N, by id - 1) in these rows and columns.
Eigen::MatrixXd BlockOf(const Eigen::MatrixXd& matrix, std::span<const int> rows, std::span<const int> columns);
/// The starting positions of agents `ids`, one row each, in W (m).
Eigen::MatrixX3d StartsOf(const Experiment& experiment, std::span<const int> ids);
/// -M_FF^-1 M_FL, for a matrix M whose M_FF is invertible. This matrix times the positions of the leaders (one row
/// each) gives the places of the followers at which M p = 0 in their rows.
Eigen::MatrixXd SharesOfLeaders(const Eigen::MatrixXd& matrix, const LedTeam& team);

/// The largest distance, along `axes`, of a follower from the place that `shares` gives it among the leaders (m).
double LargestLag(const LedTeam& team, const Eigen::MatrixXd& shares, Axes axes, std::span<const Motion> motions);
/// The length of the longest row, along `axes`.
double LongestRow(const Eigen::MatrixX3d& rows, Axes axes);

}  // namespace mascot
