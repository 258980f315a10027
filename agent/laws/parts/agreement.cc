#include "agent/laws/parts/agreement.h"

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

/// The largest extent, along one of the first `axes` axes, of the points p_W(id) over `ids`.
template <class Position>
double Extent(std::span<const int> ids, Axes axes, Position p_W) {
  Eigen::Vector3d least = p_W(ids.front()), most = least;
  for (const int id : ids) {
    least = least.cwiseMin(p_W(id));
    most = most.cwiseMax(p_W(id));
  }
  return (most - least).head(CountOf(axes)).maxCoeff();
}

}  // namespace

Eigen::Vector3d MeanStart(const Experiment& experiment) {
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();
  for (const AgentConfig& agent : experiment.agents) mean_W += agent.p_W / experiment.size();
  return mean_W;
}

double LargestSpread(const Experiment& experiment, std::span<const int> ids) {
  return Extent(ids, experiment.agent(ids.front()).law.axes, [&](int id) { return experiment.agent(id).p_W; });
}

double LargestDegree(const Graph& graph) {
  double largest = 0;
  for (int id = 1; id <= graph.size(); ++id) {
    double degree = 0;
    for (const Graph::Neighbour& j : graph.HeardBy(id)) degree += j.weight;
    largest = std::max(largest, degree);
  }
  return largest;
}

double StartDisagreement_m(const Experiment& experiment) {
  const Eigen::Vector3d mean_W = MeanStart(experiment);
  double sum = 0;
  for (const AgentConfig& agent : experiment.agents)
    sum += Along(experiment.law.axes, agent.p_W - mean_W).squaredNorm();
  return std::sqrt(sum);
}

double SquaredDisagreement(std::span<const Motion> motions, std::span<const int> ids, Axes axes) {
  const auto p_W = [&](int id) { return Along(axes, motions[static_cast<std::size_t>(id - 1)].p_WB); };
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();
  for (const int id : ids) mean_W += p_W(id) / static_cast<double>(ids.size());
  double sum = 0;
  for (const int id : ids) sum += (p_W(id) - mean_W).squaredNorm();
  return sum;
}

AgreementTime::AgreementTime(const Experiment& experiment, std::span<const int> ids, double share, double min_m)
    : experiment_(experiment),
      ids_(ids.begin(), ids.end()),
      tolerance_m_(std::max(share * LargestSpread(experiment, ids), min_m)) {}

void AgreementTime::Add(const TeamRow& row) {
  newest_ = row.tick;
  const auto p_W = [&](int id) { return row.motions[static_cast<std::size_t>(id - 1)].p_WB; };
  const double apart_m = Extent(ids_, experiment_.agent(ids_.front()).law.axes, p_W);
  if (apart_m > tolerance_m_) last_apart_ = row.tick;
  if (row.tick > experiment_.ticks()) return;  // flown ahead, beyond the end
  const bool ends = 10 * row.tick > 9 * experiment_.ticks();
  band_m_ = ends ? std::max(apart_m, band_m_) : apart_m;
}

std::optional<double> AgreementTime::time_s() const {
  if (last_apart_ == newest_) return std::nullopt;
  return experiment_.time_s(last_apart_ + 1);
}

}  // namespace mascot
