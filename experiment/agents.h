#pragma once

#include <optional>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/toml/section.h"

namespace mascot {

/// One [[agents.override]] that is not read to its end.
struct AgentOverride {
  int id = 0;  ///< 0: unknown because of a mistake
  Section section;
  std::optional<Section> law = {};  ///< the agent's own law table, whose parameters are still to be read
};

/// The keys of [agents].
std::span<const Key> AgentsKeys();
/// Reads [agents] except its count into experiment.agents; [run], [physics] and [law] must have been read. With `count`
/// = 0 (unknown because of a mistake) sizes are not checked and there are no agents. Returns the overrides: the caller
/// must still read their tables of other sections (control, law) and call Done().
std::vector<AgentOverride> ReadAgents(Section& agents, int count, Experiment& experiment);

}  // namespace mascot
