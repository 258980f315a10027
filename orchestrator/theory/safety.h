#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// What theory says of [law.safety].
struct SafetyPrediction {
  std::optional<double> min_separation_m = {};  ///< the distance that is kept between any two agents; absent: none is
  std::string assumes = {};                     ///< what must hold for it that is not known in advance; empty: nothing
  std::string silent = {};                      ///< why no distance is promised; empty: one is
  std::vector<std::string> warnings = {};       ///< "key: text"
};

/// Absent: no agent has a filter.
std::optional<SafetyPrediction> PredictSafety(const Experiment& experiment);

}  // namespace mascot
