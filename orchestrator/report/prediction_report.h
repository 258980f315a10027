#pragma once

#include <string>
#include <utility>
#include <vector>

#include "orchestrator/report/figures.h"
#include "orchestrator/report/json.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// Adds what theory predicts, with `prefix` in front of each name; docs/theory.md describes the figures. The prediction
/// must outlive them.
void AddPrediction(const Prediction& prediction, const std::string& prefix, Figures& figures);
/// The same for "predicted" in `check --json`.
Json PredictionJson(const Prediction& prediction);
/// The same as text: label and text of each line.
std::vector<std::pair<std::string, std::string>> PredictionLines(const Experiment& experiment,
                                                                 const Prediction& prediction);
/// Adds what law.safety keeps.
void AddSafetyPrediction(const SafetyPrediction& safety, const std::string& prefix, Figures& figures);
/// The same for "safety" in `check --json`, null if no agent has law.safety; and the text of its line.
Json SafetyPredictionJson(const Prediction& prediction);
std::string SafetyText(const SafetyPrediction& safety);
/// What the predicted rate, and the predicted settling time, are those of.
std::string RateBasis(const Prediction& prediction);
/// The rate of the slowest mode, where that of the start is not known. Must be predicted.
std::string SlowestRateText(const Prediction& prediction);
std::string SettlingBasis(const Experiment& experiment, const Prediction& prediction);

}  // namespace mascot
