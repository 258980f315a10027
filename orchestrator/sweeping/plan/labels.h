#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "agent/python/metrics.h"

namespace mascot {

/// A column of measured numbers as a picture says it: "consensus.settling_time_s" as "settling time (s)".
std::string LabelOfColumn(std::string_view column);
/// A metric in Python: words of its name, and the unit that it says.
std::string LabelOfMetric(const PythonMetric& metric);
/// A key of the experiment file as a picture says it, with the unit of its row: "law.p_gain" as "law.p_gain (1/s²)".
/// `laws`: those whose keys [law] may have.
std::string LabelOfKey(std::string_view key, const std::vector<std::string>& laws);

}  // namespace mascot
