#include "agent/laws/tension.h"

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

}  // namespace mascot
