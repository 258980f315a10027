#include "agent/laws/resilient/honest.h"

#include <fmt/format.h>

#include <algorithm>

#include "experiment/graph/robustness.h"

namespace mascot {

Experiment WithoutFalseData(Experiment experiment) {
  for (AgentConfig& agent : experiment.agents) agent.lie.reset();
  return experiment;
}

std::pair<int, std::size_t> MaxLiarsHeard(const Experiment& experiment) {
  std::pair<int, std::size_t> most = {0, 0};
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.lie) continue;
    std::size_t liars = 0;
    for (const Graph::Neighbour& j : experiment.graph.HeardBy(agent.id))
      if (experiment.agent(j.id).lie) ++liars;
    if (liars > most.second) most = {agent.id, liars};
  }
  return most;
}

std::vector<std::string> RobustnessWarnings(std::optional<int> robustness, int f) {
  if (!robustness) return {fmt::format("graph: its robustness is not checked: beyond {} agents", kMaxRobustness)};
  if (*robustness <= f)
    return {
        fmt::format("graph: {}-robust: {} that lie can keep honest agents apart; they agree on every {}-robust graph",
                    *robustness, f, 2 * f + 1)};
  if (*robustness <= 2 * f)
    return {fmt::format("graph: {}-robust: that honest agents agree is proved for every {}-robust graph only",
                        *robustness, 2 * f + 1)};
  return {};
}

InitialHull::InitialHull(const Experiment& experiment, std::span<const int> ids)
    : axes_(experiment.agent(ids.front()).law.axes) {
  for (const int id : ids) {
    const AgentConfig& agent = experiment.agent(id);
    if (agent.lie) continue;
    min_W_ = ids_.empty() ? agent.p_W : min_W_.cwiseMin(agent.p_W).eval();
    max_W_ = ids_.empty() ? agent.p_W : max_W_.cwiseMax(agent.p_W).eval();
    ids_.push_back(id);
  }
}

void InitialHull::Add(const TeamRow& row) {
  if (ids_.empty()) return;
  const auto p_W = [&](int id) -> const Eigen::Vector3d& { return row.motions[static_cast<std::size_t>(id - 1)].p_WB; };
  Eigen::Vector3d min_W = p_W(ids_.front()), max_W = min_W;
  for (const int id : ids_) {
    min_W = min_W.cwiseMin(p_W(id));
    max_W = max_W.cwiseMax(p_W(id));
  }
  const Eigen::Vector3d outside = (min_W_ - min_W).cwiseMax(max_W - max_W_);
  outside_m_ = std::max(outside_m_, Along(axes_, outside).maxCoeff());
  apart_m_ = Along(axes_, max_W - min_W).maxCoeff();
}

std::optional<double> InitialHull::outside_m() const {
  constexpr double kRounding_m = 1e-9;
  if (ids_.empty()) return std::nullopt;
  return outside_m_ < kRounding_m ? 0 : outside_m_;
}

std::optional<double> InitialHull::apart_m() const { return ids_.empty() ? std::nullopt : std::optional(apart_m_); }

}  // namespace mascot
