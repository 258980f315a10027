#pragma once

#include <span>
#include <string>
#include <vector>

#include "experiment/graph/graph.h"

namespace mascot {

/// Ids of the agents that hear `root` neither directly nor through others; sorted.
std::vector<int> NotReached(const Graph& graph, int root);
/// Ids of the agents that hear none of `roots`, neither directly nor through others; sorted.
std::vector<int> NotReached(const Graph& graph, std::span<const int> roots);
/// "agent 3", "agents 2, 3 and 5"; long lists are cut: "agents 2, 3, 4, 5 and 96 more".
std::string AgentList(const std::vector<int>& ids);

}  // namespace mascot
