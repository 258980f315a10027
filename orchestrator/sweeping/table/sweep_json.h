#pragma once

#include <nlohmann/json.hpp>

#include "agent/python/metrics.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/plan/run_laws.h"

namespace mascot {

// Conversions to and from JSON for what processes of a sweep send each other, and for what is kept beside tables.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PythonMetric, name, unit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(RunLaws, team, team_agrees, names, depend_on_numbers)

}  // namespace mascot
