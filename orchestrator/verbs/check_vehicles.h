#pragma once

#include "experiment/experiment.h"

namespace mascot {

/// `check --vehicles`: listens to the vehicles of an experiment for a few seconds, commands nothing, and says who is
/// there and what would be refused. Returns the exit code: 1 if a vehicle may not fly, 128 + signal if one came. Throws
/// std::invalid_argument if the experiment has no vehicles.
int CheckVehicles(const Experiment& experiment, bool json);

}  // namespace mascot
