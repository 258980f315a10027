#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "orchestrator/report/figures.h"

namespace mascot {

/// The column that a picture shows unless the user asks for another.
inline constexpr const char* kUsualMetric = "consensus.final_disagreement_m";

/// The last columns of a table, which depend on the machine, not only on the experiment.
inline constexpr std::size_t kWallClockColumns = 2;

/// Names of the metric columns of a sweep's table: those of figures (orchestrator/report/figures.h), each with one
/// number. `laws`: names of the laws whose own figures have columns.
std::vector<std::string> SweepMetricNames(const std::vector<std::string>& laws);
/// Throws ConfigError, naming the `option` that asked for it, if `column` is not one of `metrics`, or depends on the
/// machine.
void CheckColumn(const std::string& option, const std::string& column, const std::vector<std::string>& metrics);
/// The numbers of all figures of a run as cells, by the names of the figures; figures without a number are left out.
/// The table has columns for some of them.
std::map<std::string, std::string> SweepMetrics(const Figures& figures);
/// Cells of the columns `names`, by name, from the text of the summary.json of a run; a cell is empty where this has no
/// number.
std::map<std::string, std::string> SweepMetrics(const std::string& summary, const std::vector<std::string>& names);

}  // namespace mascot
