#pragma once

#include <string>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// Why closed forms for ideal agents do not hold in this experiment: bodies are not driven by what the law wants,
/// samples are lost, late, noisy or out of range, the graph changes, agents come and go. Empty: they hold, as long as
/// no limit is reached.
std::string WhyNotIdeal(const Experiment& experiment, Wanted wanted);
/// Above this many agents, closed forms that need eigenvalues are not computed.
inline constexpr int kMostModes = 1000;
/// Likewise for closed forms of single integrators on connected undirected graphs, by the graph's eigenvalues.
std::string WhyNotIdealUndirected(const Experiment& experiment);

}  // namespace mascot
