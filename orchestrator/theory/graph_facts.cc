#include "orchestrator/theory/graph_facts.h"

#include "orchestrator/theory/theory.h"

namespace mascot {

GraphFacts FactsOf(const Graph& graph, int leader) {
  GraphFacts facts;
  facts.edges = graph.edges();
  facts.symmetric = graph.IsSymmetric();
  if (graph.size() <= kLargestSpectrum) facts.lambda_2 = graph.Lambda2();
  facts.components = graph.Components();
  facts.roots = graph.Roots();
  const int root = leader > 0 ? leader : facts.roots.empty() ? 0 : facts.roots.front();
  if (root == 0) return facts;
  if (auto tree = graph.SpanningTree(root)) {
    facts.tree_root = root;
    facts.tree = std::move(*tree);
  }
  return facts;
}

std::string IdRanges(const std::vector<int>& ids) {
  std::string text;
  for (std::size_t i = 0; i < ids.size();) {
    std::size_t last = i;
    while (last + 1 < ids.size() && ids[last + 1] == ids[last] + 1) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(ids[i]);
    if (last > i) text += "-" + std::to_string(ids[last]);
    i = last + 1;
  }
  return text;
}

}  // namespace mascot
