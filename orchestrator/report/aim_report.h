#pragma once

#include <string>

#include "experiment/experiment.h"
#include "orchestrator/measuring/aim_meter.h"
#include "orchestrator/report/json.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

// What a phase of a run has come to, beside what theory predicts. `phase`: the phase as an experiment of its own.

/// "consensus" in summary.json.
Json AimJson(const Experiment& phase, const Aim& measured, const Prediction& prediction);
/// "formation" in summary.json.
Json FormationJson(const Aim::Formation& formation);
/// Mean position, decay rate and settling time, measured and predicted, in the lines of the text summary.
std::string AimText(const Experiment& phase, const Aim& measured, const Prediction& prediction);

}  // namespace mascot
