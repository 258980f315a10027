#pragma once

#include <optional>
#include <string>

#include "experiment/experiment.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// What a closed form needs of a flight.
struct Freedom {
  bool from_limits = false;    ///< no limit of speed or acceleration cuts what a law asks for
  bool from_contacts = false;  ///< nobody touches anybody, the ground or an obstacle
};

/// Why a flight is not free, by that of ideal bodies to the end of the run; empty: it is. Above kMostFreeSteps nobody
/// is flown: then `first`, the first command, must be far below its limit, and of contacts nothing is known.
std::string WhyNotFree(const Experiment& experiment, const Freedom& needed, const std::optional<FirstCommand>& first);

inline constexpr double kMostFreeSteps = 2e6;  ///< ticks times agents and edges; takes about 0.5 s

}  // namespace mascot
