#pragma once

#include <vector>

#include "experiment/live_experiment.h"
#include "orchestrator/live/shown/ui_channels.h"

namespace mascot {

/// The live keys of an experiment, with the values that they have in it now.
std::vector<ShownKey> ShownKeysOf(const LiveExperiment& live);
/// As it starts.
std::vector<ShownKey> ShownKeysOf(const Experiment& start);

}  // namespace mascot
