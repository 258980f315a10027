#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// What theory says of [law.safety].
struct SafetyPrediction {
  /// The distance, along `axes`, that is kept between any two agents; absent: none is. In space they are no nearer.
  std::optional<double> min_separation_m = {};
  Axes axes = Axes::kXyz;                  ///< of all laws
  std::string assumes = {};                ///< what must hold for it that is not known in advance; empty: nothing
  std::string silent = {};                 ///< why no distance is promised; empty: one is
  std::vector<std::string> warnings = {};  ///< "key: text"
};

/// Absent: no agent has a filter.
std::optional<SafetyPrediction> PredictSafety(const Experiment& experiment);

}  // namespace mascot
