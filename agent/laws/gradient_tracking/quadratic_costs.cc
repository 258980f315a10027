#include "agent/laws/gradient_tracking/quadratic_costs.h"

#include <fmt/format.h>

#include <utility>

#include "agent/laws/parts/inputs.h"
#include "base/linear_algebra.h"

namespace mascot {
namespace {

/// The smallest eigenvalue, where rounding counts as 0.
double Least(const Eigen::Matrix3d& q) {
  const Eigen::VectorXd values = SymmetricEigenvalues(q);
  return values(0) < -1e-9 * q.norm() ? values(0) : std::max(values(0), 0.0);
}

Eigen::Matrix3d MatrixOf(const std::vector<double>& row) {
  if (row.size() == 1) return row[0] * Eigen::Matrix3d::Identity();
  if (row.size() == 3) return Eigen::Vector3d(row[0], row[1], row[2]).asDiagonal();
  Eigen::Matrix3d q;
  q << row[0], row[1], row[2], row[1], row[3], row[4], row[2], row[4], row[5];
  return q;
}

void ReadWeights(Section& law, std::vector<QuadraticCost>& costs) {
  if (!law.Has("weights")) return;
  const std::vector<std::vector<double>> rows = law.Rows("weights");
  if (law.Wrong("weights") || costs.empty()) return;
  if (rows.size() != costs.size())
    law.Fail("weights", fmt::format("expected {} rows, one per agent, got {}", costs.size(), rows.size()));
  for (std::size_t i = 0; i < std::min(rows.size(), costs.size()); ++i) {
    if (rows[i].size() != 1 && rows[i].size() != 3 && rows[i].size() != 6) {
      law.FailRow("weights", i, fmt::format("expected 1, 3 or 6 numbers, got {}", rows[i].size()));
      continue;
    }
    costs[i].q = MatrixOf(rows[i]);
    if (const double least = Least(costs[i].q); least < 0)
      law.FailRow("weights", i,
                  fmt::format("expected a positive semidefinite matrix, got one with the eigenvalue {:.4g}", least));
  }
}

Eigen::Matrix3d SumOfWeights(const std::vector<QuadraticCost>& costs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const QuadraticCost& cost : costs) sum += cost.q;
  return sum;
}

}  // namespace

std::vector<QuadraticCost> ReadCosts(const Experiment& experiment, Section& law) {
  std::vector<QuadraticCost> costs(experiment.agents.size());
  std::vector<Eigen::Vector3d> starts;
  for (const AgentConfig& agent : experiment.agents) starts.push_back(agent.p_W);
  const std::vector<Eigen::Vector3d> targets = PointsOfAgents(experiment, law, "targets_m", std::move(starts));
  for (std::size_t i = 0; i < costs.size(); ++i) costs[i].b_W = targets[i];
  ReadWeights(law, costs);
  const Eigen::Matrix3d sum = SumOfWeights(costs);
  if (!costs.empty() && !law.Wrong("weights") && SymmetricEigenvalues(sum)(0) <= 1e-9 * sum.norm())
    law.Fail("weights", "expected costs whose sum has one minimum, got matrices whose sum is singular");
  return costs;
}

Eigen::Vector3d Minimiser(const std::vector<QuadraticCost>& costs) {
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const QuadraticCost& cost : costs) right += cost.q * cost.b_W;
  return Solve(SumOfWeights(costs), right);
}

}  // namespace mascot
