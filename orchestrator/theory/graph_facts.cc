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

}  // namespace mascot
