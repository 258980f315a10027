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
  bool assumes_safe_commands = false;      ///< it holds if agents find a safe command at every tick
  bool assumes_prompt_bodies = false;      ///< and if quadrotors accelerate as soon as they are told
  std::string assumes = {};                ///< these two in words; empty: nothing
  std::string silent = {};                 ///< why no distance is promised; empty: one is
  std::vector<std::string> warnings = {};  ///< "key: text"
};

/// Absent: no agent has a filter.
std::optional<SafetyPrediction> PredictSafety(const Experiment& experiment);

}  // namespace mascot
