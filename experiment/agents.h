#pragma once

#include <optional>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/toml/section.h"

namespace mascot {

/// What one [[agents.override]] is about.
struct AgentOverride {
  int id = 0;  ///< 0: not known for a mistake
  Section section;
  std::optional<Section> law = {};  ///< the table of a law of its own, from which its parameters are still to be read
};

/// The keys of [agents].
std::span<const Key> AgentsKeys();
/// Reads [agents], all but its count, into experiment.agents; [run], [physics] and [law] are read already.
/// With `count` = 0, not known for a mistake, sizes are not checked and there are no agents. Returns the overrides,
/// whose tables of other sections (control, law) are still to be read, and Done() to be called.
std::vector<AgentOverride> ReadAgents(Section& agents, int count, Experiment& experiment);

}  // namespace mascot
