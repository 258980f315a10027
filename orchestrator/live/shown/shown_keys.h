#pragma once

#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/live/shown/ui_channels.h"

namespace mascot {

/// The live keys of an experiment, with the values that they have in it.
std::vector<ShownKey> ShownKeysOf(const Experiment& now);

}  // namespace mascot
