#pragma once

#include <string>

#include "experiment/experiment.h"
#include "orchestrator/measuring/aim_meter.h"
#include "orchestrator/report/figures.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

// What a phase of a run has come to, beside what theory predicts. `phase`: the phase as an experiment of its own.

/// Adds "consensus" and, if the law has one, "formation", measured and predicted. The prediction must outlive the
/// figures.
void AddAim(const Experiment& phase, const Aim& measured, const Prediction& prediction, Figures& figures);
/// Mean position, decay rate, settling time and formation in the lines of the text summary. `figures`: as AddAim() has
/// added them.
std::string AimText(const Experiment& phase, const Aim& measured, const Prediction& prediction, const Figures& figures);

}  // namespace mascot
