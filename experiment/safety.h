#pragma once

#include <span>

#include "experiment/toml/section.h"

namespace mascot {

/// [law.safety], or `safety` of an agent's own law: the filter between the law and the limits (agent/safety.h).
struct SafetyConfig {
  double distance_m = 0;  ///< D: distance at which the filter keeps agents, along law.axes (m)
  double gamma = 0;       ///< 1/s
};

/// The keys of `safety`.
std::span<const Key> SafetyKeys();
SafetyConfig ReadSafety(Section& safety);

}  // namespace mascot
