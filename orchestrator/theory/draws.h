#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The keys because of which a run draws random numbers by run.seed ("agents.random", "link.loss"), each once. None:
/// the run is the same with every seed.
std::vector<std::string> DrawsOf(const Experiment& experiment);

}  // namespace mascot
