#pragma once

#include <memory>
#include <optional>

#include "agent/laws/waypoint.h"
#include "experiment/experiment.h"

namespace mascot {

/// Makes the law of a leader, which does not use what it hears: it keeps its velocity (a = 0), or flies waypoints.
std::unique_ptr<Law> MakeLeader(const std::optional<WaypointParams>& flight, const AgentConfig& agent);

}  // namespace mascot
