#pragma once

#include <optional>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/pursuit_meter.h"

namespace mascot {

/// The times at which each child of a pursuit law has caught up with its parent for good, as PursuitMeter measures them
/// on ideal bodies that fly the experiment to its end, and on to `longest_s`, with commands that hold for a control
/// period. Nothing if that is more work than kMaxFlownAgents, or if a law fails.
std::optional<std::vector<PursuitMeter::Edge>> FlyPursuit(const Experiment& experiment, double longest_s);

inline constexpr double kMaxFlownAgents = 5e5;  ///< agents times ticks; takes about 0.3 s

}  // namespace mascot
