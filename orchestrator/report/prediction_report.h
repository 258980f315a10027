#pragma once

#include <string>
#include <utility>
#include <vector>

#include "orchestrator/report/figures.h"
#include "orchestrator/report/json.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// Adds what theory predicts, with `prefix` in front of each name; docs/theory.md describes the figures. `prediction`
/// must outlive `figures`.
void AddPrediction(const Prediction& prediction, const std::string& prefix, Figures& figures);
/// The figures of AddPrediction() as JSON: "predicted" in `check --json`.
Json PredictionJson(const Prediction& prediction);
/// The prediction as text: label and text of each line that `check` prints.
std::vector<std::pair<std::string, std::string>> PredictionLines(const Experiment& experiment,
                                                                 const Prediction& prediction);
/// Adds the distance (m) between agents that law.safety keeps, or why theory is silent of it.
void AddSafetyPrediction(const SafetyPrediction& safety, const std::string& prefix, Figures& figures);
/// The figures of AddSafetyPrediction() as JSON: "safety" in `check --json`; null if no agent has law.safety.
Json SafetyPredictionJson(const Prediction& prediction);
/// The same in words, for `check` and the text summary.
std::string SafetyText(const SafetyPrediction& safety);
/// Which modes the predicted rate belongs to, in words: "slowest mode", "from this start".
std::string RateBasis(const Prediction& prediction);
/// A sentence about the rate of the slowest mode (1/s), which must be predicted: for a start whose own rate is not
/// known.
std::string SlowestRateText(const Prediction& prediction);
/// Which modes the predicted settling time belongs to, in words.
std::string SettlingBasis(const Experiment& experiment, const Prediction& prediction);

}  // namespace mascot
