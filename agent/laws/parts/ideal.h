#pragma once

#include <string>

#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

// Each function returns why a kind of closed form does not hold in an experiment; empty: it holds, as long as no limit
// is reached.

/// Closed forms of ideal agents do not hold if bodies are not driven by what the law wants, samples are lost, late,
/// noisy or out of range, the graph changes, or agents come and go.
std::string WhyNotIdeal(const Experiment& experiment, Wanted wanted);
/// As WhyNotIdeal(), but quadrotors are taken for the double integrators that they follow.
std::string WhyNotNearlyIdeal(const Experiment& experiment, Wanted wanted);
/// Closed forms of what agents compute from each other's messages do not hold if some of these do not arrive at the
/// next tick.
std::string WhyNotAllHeard(const Experiment& experiment);
/// Closed forms by eigenvalues do not hold if the graph is directed, not connected, or too large for these.
std::string WhyNotUndirected(const Experiment& experiment);
/// Both WhyNotIdeal(), for single integrators, and WhyNotUndirected().
std::string WhyNotIdealUndirected(const Experiment& experiment);

/// Above this many agents, eigenvalues are not computed.
inline constexpr int kMaxModes = 1000;

}  // namespace mascot
