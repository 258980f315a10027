#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "agent/python/metrics.h"

namespace mascot {

/// The label in a picture of a column of measured numbers: "settling time (s)" for "consensus.settling_time_s".
std::string LabelOfColumn(std::string_view column);
/// The label of a user's metric: the words of its name, and the unit that the metric declares, or else that of its
/// name.
std::string LabelOfMetric(const PythonMetric& metric);
/// The label of a key of the experiment file, with the unit of its row: "law.p_gain (1/s²)" for "law.p_gain". `laws`:
/// names of the laws whose keys [law] may have.
std::string LabelOfKey(std::string_view key, const std::vector<std::string>& laws);

}  // namespace mascot
