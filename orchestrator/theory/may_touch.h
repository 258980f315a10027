#pragma once

#include <span>
#include <string>

#include "experiment/experiment.h"
#include "experiment/motion.h"

namespace mascot {

/// What is nearer to what than `margin_m`, of what can touch in the experiment: "agents 1 and 2 may touch", "agent 3
/// may touch the ground", "agent 3 may touch an obstacle"; empty: nothing. Bodies with an airframe are boxes, as they
/// are tilted, others balls.
std::string WhatMayTouch(const Experiment& experiment, std::span<const Motion> motions, double margin_m);

}  // namespace mascot
