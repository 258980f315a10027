#include "agent/laws/rendezvous/tension.h"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace mascot {

Graph StiffnessAtStart(const Experiment& experiment, const Tension& tension) {
  std::vector<std::vector<Graph::Neighbour>> heard;
  for (const AgentConfig& agent : experiment.agents) {
    heard.emplace_back();
    for (const Graph::Neighbour& j : experiment.graph.HeardBy(agent.id)) {
      const double l = (experiment.agent(j.id).p_W - agent.p_W).norm();
      if (tension.Counts(l, false)) heard.back().push_back({j.id, tension.Stiffness(l)});
    }
  }
  return Graph(std::move(heard));
}

namespace {

constexpr double kMaxEdgesFlown = 5e6;  // times ticks

/// The diagonal of the box around `points`, which no two of them are farther apart than (m).
double Diagonal_m(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d least = points.front(), most = least;
  for (const Eigen::Vector3d& p : points) {
    least = least.cwiseMin(p);
    most = most.cwiseMax(p);
  }
  return (most - least).norm();
}

}  // namespace

std::optional<bool> KeepsEveryEdge(const Experiment& experiment, const Tension& tension) {
  const double h = experiment.period_s();
  std::vector<Eigen::Vector3d> p_W, v_W(experiment.agents.size());
  for (const AgentConfig& agent : experiment.agents) p_W.push_back(agent.p_W);
  std::set<std::pair<int, int>> counted;
  double steps = 0;
  for (std::int64_t tick = 0; tick <= experiment.ticks(); ++tick) {
    // From here on each agent goes to a place among those of the team, and the box around it shrinks.
    const double diagonal_m = Diagonal_m(p_W);
    if (diagonal_m < tension.range_m - tension.margin_m &&
        h * tension.Stiffness(diagonal_m) * (experiment.size() - 1) <= 1)
      return true;
    if ((steps += static_cast<double>(experiment.graph.edges())) > kMaxEdgesFlown) return std::nullopt;
    std::ranges::fill(v_W, Eigen::Vector3d::Zero());
    for (int i = 1; i <= experiment.size(); ++i)
      for (const Graph::Neighbour& j : experiment.graph.HeardBy(i)) {
        const Eigen::Vector3d way_W = p_W[static_cast<std::size_t>(j.id - 1)] - p_W[static_cast<std::size_t>(i - 1)];
        const double l = way_W.norm();
        if (tension.Counts(l, counted.contains({i, j.id}))) {
          counted.insert({i, j.id});
          v_W[static_cast<std::size_t>(i - 1)] += tension.Stiffness(l) * way_W;
        } else if (counted.contains({i, j.id})) {
          return false;
        }
      }
    for (std::size_t i = 0; i < p_W.size(); ++i) p_W[i] += h * Along(experiment.law.axes, v_W[i]);
  }
  return true;
}

}  // namespace mascot
