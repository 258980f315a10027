#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// What theory says of [law.safety].
struct SafetyPrediction {
  /// The distance (m), along `axes`, that any two agents keep; absent: they keep none. In space they are no nearer.
  std::optional<double> min_separation_m = {};
  Axes axes = Axes::kXyz;                  ///< axes of all laws
  bool assumes_safe_commands = false;      ///< the distance holds only if agents find a safe command at every tick
  bool assumes_prompt_bodies = false;      ///< and only if quadrotors accelerate as soon as they are commanded
  std::string assumes = {};                ///< these two in words; empty: nothing
  std::string silent = {};                 ///< why no distance is promised; empty: one is
  std::vector<std::string> warnings = {};  ///< "key: text"
};

/// Absent: no agent has a filter.
std::optional<SafetyPrediction> PredictSafety(const Experiment& experiment);

}  // namespace mascot
