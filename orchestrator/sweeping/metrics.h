#pragma once

#include <string>
#include <vector>

namespace mascot {

/// Names of the metric columns of a sweep's table: dotted keys of summary.json, each with one number.
std::vector<std::string> SweepMetricNames();
/// Cells of these columns, from the text of a summary.json; empty where it has no number.
std::vector<std::string> SweepMetrics(const std::string& summary);

}  // namespace mascot
