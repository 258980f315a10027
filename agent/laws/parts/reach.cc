#include "agent/laws/parts/reach.h"

namespace mascot {

std::vector<int> NotReached(const Graph& graph, int root) { return NotReached(graph, std::span<const int>(&root, 1)); }

std::vector<int> NotReached(const Graph& graph, std::span<const int> roots) {
  const auto count = static_cast<std::size_t>(graph.size());
  std::vector<std::vector<int>> hearers(count);  // by id - 1: the agents that hear this one
  for (int id = 1; id <= graph.size(); ++id) {
    for (const Graph::Neighbour& heard : graph.HeardBy(id))
      hearers[static_cast<std::size_t>(heard.id - 1)].push_back(id);
  }
  std::vector<bool> reached(count, false);
  std::vector<int> open(roots.begin(), roots.end());
  for (const int root : roots) reached[static_cast<std::size_t>(root - 1)] = true;
  while (!open.empty()) {
    const auto from = static_cast<std::size_t>(open.back() - 1);
    open.pop_back();
    for (const int id : hearers[from]) {
      if (reached[static_cast<std::size_t>(id - 1)]) continue;
      reached[static_cast<std::size_t>(id - 1)] = true;
      open.push_back(id);
    }
  }
  std::vector<int> rest;
  for (int id = 1; id <= graph.size(); ++id) {
    if (!reached[static_cast<std::size_t>(id - 1)]) rest.push_back(id);
  }
  return rest;
}

std::string AgentList(const std::vector<int>& ids) {
  constexpr std::size_t kShown = 5;
  if (ids.size() == 1) return "agent " + std::to_string(ids[0]);
  const bool cut = ids.size() > kShown;
  const std::size_t listed = cut ? kShown - 1 : ids.size() - 1;
  std::string text = "agents ";
  for (std::size_t i = 0; i < listed; ++i) text += (i == 0 ? "" : ", ") + std::to_string(ids[i]);
  return text + " and " + (cut ? std::to_string(ids.size() - listed) + " more" : std::to_string(ids[listed]));
}

}  // namespace mascot
