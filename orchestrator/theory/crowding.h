#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Warnings ("key: text") about bodies that start in the ground, or that will touch because the law
/// brings all agents to one place. (ReadExperiment refuses bodies that touch at the start.)
std::vector<std::string> CrowdingWarnings(const Experiment& experiment);

}  // namespace mascot
