#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Which agents the team cannot lose.
struct LossTolerance {
  /// Agents without which, each alone, the others have no spanning tree as in Survival, in the graph of the file (the
  /// union of a schedule that repeats, else its last phase). Agents that stop during the run do not count.
  std::vector<int> cannot_lose;
  bool is_known = true;  ///< false: it would take more than kMaxSurvivalWork
  std::string words;     ///< "any one agent may be lost"
};
/// Nothing for a law that needs no spanning tree, for fewer than 3 agents, and if there is no tree with all agents.
std::optional<LossTolerance> LossToleranceOf(const Experiment& experiment);

}  // namespace mascot
