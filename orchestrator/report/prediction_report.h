#pragma once

#include <string>
#include <utility>
#include <vector>

#include "orchestrator/report/json.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// "predicted" of `check --json` and of summary.json: keys in docs/theory.md.
Json PredictionJson(const Prediction& prediction);
/// The same for people: label and text of each line.
std::vector<std::pair<std::string, std::string>> PredictionLines(const Experiment& experiment,
                                                                 const Prediction& prediction);

}  // namespace mascot
