#pragma once

#include <string>
#include <vector>

namespace mascot {

/// Columns of a sweep's table that hold what a run measured: the keys of summary.json, dotted, one number each.
std::vector<std::string> SweepMetricNames();
/// Their cells, from the text of a summary.json; empty where it has none.
std::vector<std::string> SweepMetrics(const std::string& summary);

}  // namespace mascot
