#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// A warning ("key: text") about the first body that a step of the physics takes farther than its own smallest size, at
/// the speed with which it starts, or with which a law drives it at first. Contacts are found where bodies are at a
/// step, not on the way to it: such a body may pass through others, obstacles and the ground. `driven_m_per_s` is the
/// largest component of a velocity that a law wants at tick 0, after limits; 0: no law wants one.
std::vector<std::string> StepLengthWarnings(const Experiment& experiment, double driven_m_per_s);

}  // namespace mascot
