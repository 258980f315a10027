#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "orchestrator/measuring/law_meters.h"
#include "orchestrator/report/figures.h"
#include "orchestrator/report/json.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

// The figures that laws measure beyond those that all laws share. `prediction` is about the law of the team.

/// Adds for each law its figures as measured, "predicted", "bounds", "tolerances", "rounding" and "reasons".
void AddLaws(const Experiment& experiment, std::span<const LawMeasured> measured, const Prediction& prediction,
             Figures& figures);
/// The figures of AddLaws() as lines of the text summary.
std::string LawsText(const Experiment& experiment, std::span<const LawMeasured> measured, const Prediction& prediction);
/// Adds the predicted figures by name: "figures", "figure_bounds", "figure_tolerances", "figure_rounding" and
/// "figure_reasons" of `check --json`.
void AddPredictedFigures(const Experiment& experiment, const Prediction& prediction, Json& json);
/// The predicted figures as text: label and text of each line that `check` prints.
std::vector<std::pair<std::string, std::string>> PredictedFigureLines(const Experiment& experiment,
                                                                      const Prediction& prediction);

}  // namespace mascot
