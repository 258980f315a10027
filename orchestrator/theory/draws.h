#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// What a run draws at random by run.seed, as the keys that ask for it ("agents.random", "link.loss"), each once. None:
/// the run is the same with every seed.
std::vector<std::string> DrawsOf(const Experiment& experiment);

}  // namespace mascot
