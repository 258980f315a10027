#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "orchestrator/report/json.h"
#include "orchestrator/theory/loss_tolerance.h"
#include "orchestrator/theory/survival.h"

namespace mascot {

/// "survival" in `check --json`: an entry for each time at which it changes.
Json SurvivalJson(const Experiment& experiment, const SurvivalOfRun& survival);
/// "cannot_lose" in `check --json`: the agents; null: theory says nothing of it.
Json LossToleranceJson(const std::optional<LossTolerance>& tolerance);
/// The same as text: label and text of each line that `check` prints. Of many times, the first.
std::vector<std::pair<std::string, std::string>> SurvivalLines(const Experiment& experiment,
                                                               const SurvivalOfRun& survival);

}  // namespace mascot
