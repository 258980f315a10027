#pragma once

#include "experiment/experiment.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// Compares the predictions for a linear team from its start (where agents meet, and how fast) with a flight of its
/// quadrotors on LowLevelLoops, which turn before they accelerate and have a limit of the tilt. A prediction that is
/// off by more than its tolerance is replaced by the value of this flight. If the loops do not describe the flight, the
/// prediction is removed, with the reason.
void JudgeAgreementOnLoops(const Experiment& experiment, Prediction& prediction);

}  // namespace mascot
