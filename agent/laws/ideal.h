#pragma once

#include <string>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

// Why closed forms do not hold in an experiment. Empty: they hold, as long as no limit is reached.

/// Of what ideal agents do: bodies are not driven by what the law wants, samples are lost, late, noisy or out of range,
/// the graph changes, agents come and go.
std::string WhyNotIdeal(const Experiment& experiment, Wanted wanted);
/// Of what agents compute from each other's messages alone: not all of these arrive at the next tick.
std::string WhyNotAllHeard(const Experiment& experiment);
/// Of connected undirected graphs, by their eigenvalues.
std::string WhyNotUndirected(const Experiment& experiment);
/// Of ideal single integrators on such graphs.
std::string WhyNotIdealUndirected(const Experiment& experiment);

/// Above this many agents, eigenvalues are not computed.
inline constexpr int kMostModes = 1000;

}  // namespace mascot
