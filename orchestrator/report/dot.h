#pragma once

#include <string>

#include "experiment/graph/graph.h"

namespace mascot {

/// `graph` as Graphviz text. Arrows show the flow of information: from the agent that is heard to the agent that hears.
/// A symmetric graph is drawn without arrows. `leader` (0: none) has a double circle. `caption` is printed below the
/// graph.
std::string ToDot(const Graph& graph, int leader, const std::string& caption = "");

}  // namespace mascot
