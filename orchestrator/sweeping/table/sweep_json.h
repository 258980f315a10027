#pragma once

#include <nlohmann/json.hpp>

#include "agent/python/metrics.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/plan/run_laws.h"

namespace mascot {

// What of a sweep stands in JSON, between processes and beside tables.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PythonMetric, name, unit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RunLaws, team, team_agrees, names, depend_on_numbers)

}  // namespace mascot
