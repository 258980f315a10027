#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "orchestrator/report/figures.h"

namespace mascot {

/// The column that is drawn unless another is asked for.
inline constexpr const char* kUsualMetric = "consensus.final_disagreement_m";

/// The last columns of a table, which depend on the machine, not only on the experiment.
inline constexpr std::size_t kWallClockColumns = 2;

/// Names of the metric columns of a sweep's table: those of figures (orchestrator/report/figures.h), each with one
/// number. `laws`: names of the laws whose own figures have columns.
std::vector<std::string> SweepMetricNames(const std::vector<std::string>& laws);
/// Throws ConfigError, naming --plot, if `column` is not one of `metrics`, or depends on the machine.
void CheckPlotted(const std::string& column, const std::vector<std::string>& metrics);
/// The cells of a run by the names of their columns, and of figures that have none; those without a number are left
/// out.
std::map<std::string, std::string> SweepMetrics(const Figures& figures);
/// Cells of these columns by name, from the text of the summary.json that a run has left; empty where it has no number.
std::map<std::string, std::string> SweepMetrics(const std::string& summary, const std::vector<std::string>& names);

}  // namespace mascot
