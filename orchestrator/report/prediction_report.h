#pragma once

#include <string>
#include <utility>
#include <vector>

#include "orchestrator/report/json.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// JSON for "predicted" in `check --json` and summary.json; docs/theory.md describes the keys.
Json PredictionJson(const Prediction& prediction);
/// The same as text: label and text of each line.
std::vector<std::pair<std::string, std::string>> PredictionLines(const Experiment& experiment,
                                                                 const Prediction& prediction);
/// The same of law.safety: JSON for "safety" in `check --json` and for "safety.predicted" in summary.json, null if no
/// agent has it; and the text of its line.
Json SafetyPredictionJson(const Prediction& prediction);
std::string SafetyText(const SafetyPrediction& safety);
/// What the predicted rate, and the predicted settling time, are those of.
std::string RateBasis(const Prediction& prediction);
/// The rate of the slowest mode, where that of the start is not known. Must be predicted.
std::string SlowestRateText(const Prediction& prediction);
std::string SettlingBasis(const Experiment& experiment, const Prediction& prediction);

}  // namespace mascot
