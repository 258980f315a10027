#pragma once

#include <string>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// Why closed forms for ideal agents do not hold in this experiment: bodies are not driven by what the law wants,
/// samples are lost, late, noisy or out of range, the graph changes, agents come and go. Empty: they hold, as long as
/// no limit is reached.
std::string WhyNotIdeal(const Experiment& experiment, Wanted wanted);
/// Likewise for closed forms of single integrators on connected undirected graphs.
std::string WhyNotIdealUndirected(const Experiment& experiment);

}  // namespace mascot
