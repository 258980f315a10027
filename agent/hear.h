#pragma once

#include <span>
#include <vector>

#include "agent/law.h"
#include "experiment/graph.h"

namespace mascot {

/// What agent `id` hears when everybody's motion (by id - 1) is at hand: the graph decides. For engines
/// that hold all agents in one process.
inline void HearAll(const Graph& graph, int id, std::span<const Motion> motions, std::vector<Heard>& heard) {
  heard.clear();
  for (const Graph::Neighbour& neighbour : graph.HeardBy(id))
    heard.push_back({neighbour.id, neighbour.weight, motions[static_cast<std::size_t>(neighbour.id - 1)]});
}

}  // namespace mascot
