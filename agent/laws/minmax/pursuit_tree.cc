#include "agent/laws/minmax/pursuit_tree.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/parts/reach.h"
#include "experiment/experiment.h"

namespace mascot {
namespace {

/// law.beta as one bound per agent (m/s^2), also after a mistake.
std::vector<double> ReadBeta(Section& law, int agents) {
  const auto count = static_cast<std::size_t>(agents);
  if (law.Kind("beta") != "list") return std::vector<double>(count, law.Number("beta"));
  std::vector<double> beta = law.Numbers("beta");
  if (beta.size() != count && !law.Wrong("beta")) {
    law.Fail("beta",
             "expected " + std::to_string(count) + " numbers, one per agent, got " + std::to_string(beta.size()));
  }
  beta.resize(count, 1.0);
  return beta;
}

/// Each agent's parent, by id - 1; all 0 if there is no tree.
std::vector<int> ReadTree(const Experiment& experiment, int root, Section& law) {
  const std::vector<int> nobody(static_cast<std::size_t>(experiment.size()), 0);
  // A mistake in the graph or the leader has been noted already.
  if (law.Wrong("leader") || experiment.graph.size() != experiment.size()) return nobody;
  if (root == 0) {
    law.Fail("leader", "expected the root of the tree in 1..N, got 0");
    return nobody;
  }
  if (const auto tree = experiment.graph.SpanningTree(root)) return *tree;
  law.Fail("leader", "expected a root that every agent hears, directly or not, got " + std::to_string(root) +
                         ", which does not reach " + AgentList(NotReached(experiment.graph, root)));
  return nobody;
}

/// Checks beta_c > beta_p on every edge, without which the law promises nothing.
void CheckEdges(const PursuitForm& tree, int root, bool root_bound, Section& law) {
  std::string first;
  int others = 0;
  for (std::size_t i = 0; i < tree.parent.size(); ++i) {
    if (tree.parent[i] == 0 || tree.beta[i] > tree.parent_beta[i]) continue;
    if (!first.empty()) {
      ++others;
      continue;
    }
    const std::string child = std::to_string(i + 1);
    const std::string parent = std::to_string(tree.parent[i]);
    const std::string bound_of = root_bound ? "the root " + std::to_string(root) : "its parent " + parent;
    first = "expected beta of agent " + child + " above that of " + bound_of + " (edge " + child + " -> " + parent +
            "), got " + ShortestFloat(tree.beta[i]) + " and " + ShortestFloat(tree.parent_beta[i]);
  }
  if (first.empty()) return;
  if (others > 0) first += " (and " + std::to_string(others) + (others == 1 ? " more edge)" : " more edges)");
  law.Fail("beta", first);
}

}  // namespace

PursuitForm ReadPursuitTree(const Experiment& experiment, const LawConfig& config, Section& law) {
  PursuitForm tree;
  tree.parent = ReadTree(experiment, config.leader, law);
  tree.beta = ReadBeta(law, experiment.size());
  const bool root_bound = law.OneOf("weak_edges") == "root";
  tree.parent_beta.resize(tree.beta.size(), 0.0);
  for (std::size_t i = 0; i < tree.parent.size(); ++i) {
    if (tree.parent[i] == 0) continue;
    const int bound_of = root_bound ? config.leader : tree.parent[i];
    tree.parent_beta[i] = tree.beta[static_cast<std::size_t>(bound_of - 1)];
  }
  if (!law.Wrong("beta")) CheckEdges(tree, config.leader, root_bound, law);
  return tree;
}

}  // namespace mascot
