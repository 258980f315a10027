#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// A delay as a run has it: asked for in seconds, in effect in whole ticks.
struct DelayInEffect {
  std::string key;
  double asked_s = 0;
  double jitter_s = 0;         ///< each sample's own delay lies within asked_s -+ jitter_s
  std::int64_t min_ticks = 0;  ///< delay of the samples that arrive soonest, without reordering
  std::int64_t max_ticks = 0;  ///< delay of the samples that arrive latest

  bool operator==(const DelayInEffect&) const = default;
};

/// Every delay of a link of the graph, and of the agents' own sensors, that is not 0. Each once, in order of agents.
std::vector<DelayInEffect> DelaysInEffect(const Experiment& experiment);

}  // namespace mascot
