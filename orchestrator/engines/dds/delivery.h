#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// "key: text", for keys of [network] that make a run over DDS slower than it need be.
std::vector<std::string> DeliveryWarnings(const Experiment& experiment);
/// Refuses more processes than one host can hold, with ConfigError.
void RefuseTooManyProcesses(const Experiment& experiment);

}  // namespace mascot
