#pragma once

#include <optional>

#include "experiment/graph/graph.h"

namespace mascot {

/// Up to this many agents, robustness is computed: it looks at all their subsets.
inline constexpr int kMaxRobustness = 16;

/// The largest r for which the graph is r-robust: of any two disjoint groups of agents, one has an agent that hears at
/// least r agents outside its group (LeBlanc, Zhang, Koutsoukos & Sundaram, IEEE J. Selected Areas in Communications
/// 31, 2013). 1 for one agent. Weights do not matter. Nothing beyond kMaxRobustness agents.
std::optional<int> RobustnessOf(const Graph& graph);

}  // namespace mascot
