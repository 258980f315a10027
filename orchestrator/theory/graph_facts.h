#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/graph/graph.h"

namespace mascot {

/// What `check` and `graph` say about a graph.
struct GraphFacts {
  std::size_t edges = 0;
  bool symmetric = false;
  std::optional<double> lambda_2;            ///< left out above kLargestSpectrum agents
  std::vector<std::vector<int>> components;  ///< strongly connected
  std::vector<int> roots;                    ///< heard by everyone, directly or not
  int tree_root = 0;                         ///< the leader, else the lowest root; 0: no spanning tree
  std::vector<int> tree;                     ///< parent by id - 1; empty if there is no spanning tree
};

GraphFacts FactsOf(const Graph& graph, int leader);
/// Ids with runs joined: "1-4, 7".
std::string IdRanges(const std::vector<int>& ids);

}  // namespace mascot
