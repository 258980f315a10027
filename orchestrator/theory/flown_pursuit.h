#pragma once

#include <optional>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/measuring/pursuit_meter.h"

namespace mascot {

/// When each child of a pursuit law has caught up with its parent for good, as PursuitMeter measures it of ideal bodies
/// that fly the experiment to its end, and on to `longest_s`, with commands that are held for a control period. Nothing
/// if that is more work than kMostFlownAgents, or the laws fail.
std::optional<std::vector<PursuitMeter::Edge>> FlyPursuit(const Experiment& experiment, double longest_s);

inline constexpr double kMostFlownAgents = 5e5;  ///< agents times ticks; takes about 0.3 s

}  // namespace mascot
