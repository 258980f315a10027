#pragma once

#include <optional>
#include <vector>

#include "experiment/graph/graph.h"

namespace mascot {

/// Properties of a graph that `check` and `graph` report.
struct GraphFacts {
  std::size_t edges = 0;
  bool symmetric = false;
  std::optional<double> lambda_2;            ///< absent above kLargestSpectrum agents
  std::vector<std::vector<int>> components;  ///< ids of each strongly connected component
  std::vector<int> roots;                    ///< agents that all others hear, directly or not
  int tree_root = 0;                         ///< root of `tree`: the leader, else the lowest root; 0: no spanning tree
  std::vector<int> tree;                     ///< parent by id - 1; empty if there is no spanning tree
};

/// `leader`: 0 for none.
GraphFacts FactsOf(const Graph& graph, int leader);

}  // namespace mascot
