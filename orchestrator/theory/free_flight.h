#pragma once

#include <optional>
#include <string>

#include "experiment/experiment.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// What a flight must be free from, so that a closed form holds.
struct Freedom {
  bool from_limits = false;    ///< no limit of speed or acceleration cuts what a law wants
  bool from_contacts = false;  ///< no body touches another one, the ground or an obstacle
};

/// Why the flight of the run is not free, found by a flight of ideal bodies to the end of the run; empty: it is free.
/// Above kMaxFreeSteps there is no such flight: then `first`, the first command, must be far below its limit, and
/// nothing is known of contacts.
std::string WhyNotFree(const Experiment& experiment, const Freedom& needed, const std::optional<FirstCommand>& first);

inline constexpr double kMaxFreeSteps = 2e6;  ///< ticks times agents and edges; takes about 0.5 s

}  // namespace mascot
