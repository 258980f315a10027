#pragma once

#include <optional>

#include "orchestrator/measuring/aim_meter.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// Measured minus predicted values; absent where either is absent.
struct Deviation {
  std::optional<double> value_m;  ///< distance between mean position and predicted point, along law.axes
  std::optional<double> settling_time_s;
  std::optional<double> rate_per_s;
  std::optional<double> minmax_time_s;  ///< for the last of the edges with a predicted time
};

Deviation Compare(const Experiment& experiment, const Aim& measured, const Prediction& prediction);
/// Time at which the last of the edges with a predicted time caught up (s). Absent if one has not, or if there are
/// none.
std::optional<double> MinmaxTime(const Aim& measured, const Prediction& prediction);

}  // namespace mascot
