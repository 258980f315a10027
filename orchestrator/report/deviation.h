#pragma once

#include <optional>

#include "orchestrator/measuring/metrics.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// What was measured, less what theory predicted; absent where either is.
struct Deviation {
  std::optional<double> value_m;  ///< distance of the agents' mean to the predicted point, over law.axes
  std::optional<double> settling_time_s;
  std::optional<double> rate_per_s;
  std::optional<double> minmax_time_s;  ///< of the latest of the edges that theory knows
};

Deviation Compare(const Experiment& experiment, const Measured& measured, const Prediction& prediction);
/// When the latest of the edges whose time theory knows was met; absent if one was not, or if it knows none.
std::optional<double> MinmaxTime(const Measured& measured, const Prediction& prediction);

}  // namespace mascot
