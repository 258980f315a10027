#pragma once

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"

namespace mascot {

// Modes of p(k+1) = (I - step L) p(k) on the experiment's graph, which is connected and undirected.

/// lambda_n, the largest eigenvalue of L: its norm.
double LargestRoot(const Experiment& experiment);
/// max |1 - step lambda| over the modes other than that of the mean: the largest share of a disagreement that remains
/// from tick to tick.
double SlowestFactor(const Experiment& experiment, double step);
/// What theory says of a law.gain with which SlowestFactor() is 1 or more.
LawTheory UnstableGain(const Experiment& experiment);

}  // namespace mascot
