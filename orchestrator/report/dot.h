#pragma once

#include <string>

#include "experiment/graph/graph.h"

namespace mascot {

/// `graph` as Graphviz text. Arrows point the way that information flows: from the one who is heard to the one who
/// hears. A symmetric graph is drawn without arrows. `leader` (0: none) has a double circle. `caption`
/// stands below the picture.
std::string ToDot(const Graph& graph, int leader, const std::string& caption = "");

}  // namespace mascot
