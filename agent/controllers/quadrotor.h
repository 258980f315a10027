#pragma once

#include <memory>
#include <span>
#include <vector>

#include "agent/controller.h"
#include "experiment/experiment.h"

namespace mascot {

/// The controller of the quadrotors `ids`. `max_lanes`: how many to compute at once at most; the bits do not depend on
/// it.
std::unique_ptr<Controller> MakeQuadrotorController(const Experiment& experiment, std::span<const int> ids,
                                                    int max_lanes);
/// The numbers of lanes that this processor can have, the largest first.
std::vector<int> LanesOfQuadrotors();

}  // namespace mascot
