#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/theory/loop_team.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// Predicts, as bands, the figures of the team's law that its own theory leaves out because bodies lag behind what the
/// law wants: quadrotors, and bodies driven by acceleration under a law that wants velocities. Where it cannot, it says
/// why. docs/theory.md says how, and how wide the bands are.
void PredictOnLoops(const Experiment& experiment, Prediction& prediction);

/// Flights of bodies that turn and accelerate somewhat more or less than their model: all, or those up to the first
/// after which `goes_on` returns false.
std::vector<LoopFlight> FlyBeside(const Experiment& experiment, const std::function<bool(const LoopFlight&)>& goes_on);

/// Why LowLevelLoops do not describe the bodies; empty: they may.
std::string WhyNotLoops(const Experiment& experiment);

/// Work of one flight (WorkOfLoops); five flights of this take about a second.
inline constexpr double kMaxLoopWork = 6e5;

}  // namespace mascot
