#include "orchestrator/report/dot.h"

#include <fmt/format.h>

namespace mascot {

std::string ToDot(const Graph& graph, int leader, const std::string& caption) {
  const bool directed = !graph.IsSymmetric();
  std::string dot = directed
                        ? "// An arrow j -> i: agent i hears agent j. Its label: the weight, unless 1.\ndigraph {\n"
                        : "// A line: both hear each other. Its label: the weight, unless 1.\ngraph {\n";
  if (!caption.empty()) dot += fmt::format("  label=\"{}\"\n", caption);
  dot += "  node [shape=circle]\n";
  for (int id = 1; id <= graph.size(); ++id)
    dot += fmt::format("  {}{}\n", id, id == leader ? " [shape=doublecircle]" : "");
  for (int i = 1; i <= graph.size(); ++i) {
    for (const Graph::Neighbour& j : graph.HeardBy(i)) {
      if (!directed && j.id < i) continue;  // already drawn
      const std::string edge = directed ? fmt::format("{} -> {}", j.id, i) : fmt::format("{} -- {}", i, j.id);
      dot += fmt::format("  {}{}\n", edge, j.weight == 1 ? "" : fmt::format(" [label=\"{}\"]", j.weight));
    }
  }
  return dot + "}\n";
}

}  // namespace mascot
