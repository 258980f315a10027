#pragma once

#include <string>
#include <utility>

namespace mascot {

/// An edge of the graph: hearer, heard.
using Edge = std::pair<int, int>;

/// "[2, 1]", as edges are written in the file: 2 hears 1.
inline std::string EdgeText(const Edge& edge) {
  return "[" + std::to_string(edge.first) + ", " + std::to_string(edge.second) + "]";
}

}  // namespace mascot
