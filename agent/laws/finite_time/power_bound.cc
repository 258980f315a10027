#include "agent/laws/finite_time/power_bound.h"

#include <cmath>
#include <utility>
#include <vector>

#include "agent/laws/parts/agreement.h"

namespace mascot {
namespace {

/// lambda_2 of the Laplacian of the weights (gain a_ij)^(2/(1+alpha)).
double Lambda2OfPower(const Graph& graph, double gain, double alpha) {
  std::vector<std::vector<Graph::Neighbour>> heard;
  for (int id = 1; id <= graph.size(); ++id) {
    heard.push_back(graph.HeardBy(id));
    for (Graph::Neighbour& j : heard.back()) j.weight = std::pow(gain * j.weight, 2 / (1 + alpha));
  }
  return Graph(std::move(heard)).Lambda2();
}

}  // namespace

double LongestTimeOfPower_s(const Experiment& experiment, double gain, double alpha) {
  const Eigen::Vector3d mean_W = MeanStart(experiment);
  Eigen::Vector3d v = Eigen::Vector3d::Zero();  // V, per axis
  for (const AgentConfig& agent : experiment.agents) v += (agent.p_W - mean_W).cwiseAbs2() / 2;
  const double largest_v = v.head(CountOf(experiment.law.axes)).maxCoeff();
  if (largest_v == 0) return 0;
  const double lambda = Lambda2OfPower(experiment.graph, gain, alpha);
  return 4 * std::pow(largest_v, (1 - alpha) / 2) / ((1 - alpha) * std::pow(4 * lambda, (1 + alpha) / 2));
}

}  // namespace mascot
