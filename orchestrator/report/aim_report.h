#pragma once

#include <string>

#include "experiment/experiment.h"
#include "orchestrator/measuring/aim_meter.h"
#include "orchestrator/report/figures.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

// What a phase of a run has come to, beside what theory predicts. `phase`: the phase as an experiment of its own.

/// Adds the figures of "consensus", measured, predicted and the difference of both, and, if a formation was measured,
/// those of "formation". `prediction` must outlive `figures`.
void AddAim(const Experiment& phase, const Aim& measured, const Prediction& prediction, Figures& figures);
/// Mean position, decay rate, settling time and formation as lines of the text summary. `figures` must have those that
/// AddAim() adds.
std::string AimText(const Experiment& phase, const Aim& measured, const Prediction& prediction, const Figures& figures);

}  // namespace mascot
