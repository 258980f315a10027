#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Warnings ("key: text") about waypoints whose straight ways pass through obstacles, for laws that do not keep clear
/// of them, about waypoints in obstacles for laws that do, and about a range sensor that no law asks.
std::vector<std::string> ObstacleWarnings(const Experiment& experiment);

}  // namespace mascot
