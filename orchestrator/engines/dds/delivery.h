#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// Warnings ("key: text") about keys of [network] that make a run over DDS slower than it could be.
std::vector<std::string> DeliveryWarnings(const Experiment& experiment);
/// Throws ConfigError if the experiment has more agent processes on this host than one DDS domain can hold.
void RefuseTooManyProcesses(const Experiment& experiment);

}  // namespace mascot
