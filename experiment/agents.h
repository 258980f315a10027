#pragma once

#include "experiment/experiment.h"

namespace mascot {

/// Reads [agents], all but its count, into experiment.agents; [run], [physics] and [law] are read already.
/// With `count` = 0, not known for a mistake, sizes are not checked and there are no agents.
void ReadAgents(Section& agents, int count, std::span<const std::string_view> models, Experiment& experiment);

}  // namespace mascot
