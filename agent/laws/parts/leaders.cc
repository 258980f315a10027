#include "agent/laws/parts/leaders.h"

#include <algorithm>
#include <string>
#include <utility>

#include "base/linear_algebra.h"
#include "experiment/agent_ids.h"

namespace mascot {

LedTeam::LedTeam(std::vector<int> leader_ids, int agents) : leaders(std::move(leader_ids)) {
  for (int id = 1; id <= agents; ++id)
    if (!IsLeader(id)) followers.push_back(id);
}

bool LedTeam::IsLeader(int id) const { return std::ranges::binary_search(leaders, id); }

std::vector<int> ReadLeaders(const Experiment& experiment, Section& section) {
  std::vector<int> leaders = ReadAgentIds(section, "leaders", experiment.size());
  if (!section.Wrong("leaders") && std::ssize(leaders) == experiment.size())
    section.Fail("leaders", "expected fewer leaders than agents, got " + std::to_string(leaders.size()));
  return leaders;
}

Eigen::MatrixXd BlockOf(const Eigen::MatrixXd& matrix, std::span<const int> rows, std::span<const int> columns) {
  Eigen::MatrixXd block(std::ssize(rows), std::ssize(columns));
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < columns.size(); ++c)
      block(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = matrix(rows[r] - 1, columns[c] - 1);
  return block;
}

Eigen::MatrixX3d StartsOf(const Experiment& experiment, std::span<const int> ids) {
  Eigen::MatrixX3d starts(std::ssize(ids), 3);
  for (std::size_t i = 0; i < ids.size(); ++i)
    starts.row(static_cast<Eigen::Index>(i)) = experiment.agent(ids[i]).p_W.transpose();
  return starts;
}

Eigen::MatrixXd SharesOfLeaders(const Eigen::MatrixXd& matrix, const LedTeam& team) {
  return -SolveColumns(BlockOf(matrix, team.followers, team.followers), BlockOf(matrix, team.followers, team.leaders));
}

double LongestRow(const Eigen::MatrixX3d& rows, Axes axes) {
  return rows.rows() == 0 ? 0 : rows.leftCols(CountOf(axes)).rowwise().norm().maxCoeff();
}

double LargestLag(const LedTeam& team, const Eigen::MatrixXd& shares, Axes axes, std::span<const Motion> motions) {
  const auto p_WB = [&](const std::vector<int>& ids) {
    Eigen::MatrixX3d rows(std::ssize(ids), 3);
    for (std::size_t i = 0; i < ids.size(); ++i)
      rows.row(static_cast<Eigen::Index>(i)) = motions[static_cast<std::size_t>(ids[i] - 1)].p_WB.transpose();
    return rows;
  };
  return LongestRow(p_WB(team.followers) - shares * p_WB(team.leaders), axes);
}

}  // namespace mascot
