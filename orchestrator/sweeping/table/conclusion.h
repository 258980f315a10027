#pragma once

#include <string>
#include <vector>

#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/table/sweep_identity.h"
#include "orchestrator/sweeping/table/table.h"

namespace mascot {

/// Writes the statistics of a complete table to a file beside it (StatisticsBeside(out)); `out` is the path of the
/// table. Returns lines for the terminal.
std::vector<std::string> Conclude(const SweepPlan& plan, const SweepIdentity& identity, const SweepFile& table,
                                  const std::string& out);

}  // namespace mascot
