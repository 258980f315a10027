#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Warnings, as "key: text", about bodies that start in the ground, or that will touch because the law
/// brings all agents to one place. (Bodies that touch at the start are refused by ReadExperiment.)
std::vector<std::string> CrowdingWarnings(const Experiment& experiment);

}  // namespace mascot
