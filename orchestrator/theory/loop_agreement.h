#pragma once

#include "experiment/experiment.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// Holds what is predicted of a linear team from its start, where agents meet and how fast, against a flight of its
/// quadrotors on LowLevelLoops, which turn before they accelerate and have a limit of the tilt. What is off there by
/// more than it may be is that of this flight; where the loops do not describe the flight, it is not predicted, and the
/// reason is told.
void JudgeAgreementOnLoops(const Experiment& experiment, Prediction& prediction);

}  // namespace mascot
