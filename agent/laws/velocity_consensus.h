#pragma once

#include "agent/laws.h"
#include "experiment/experiment.h"

namespace mascot {

inline constexpr Key kVelocityConsensusParameters[] = {
    key::Number("p_gain", {0, 1000}, "pull towards each neighbour, times its weight").Default("1.0").Unit("1/s").Live(),
    key::Integer("leader", 0, kMaxAgents, "agent that leads, by wanting the velocity 0, 1..N; 0: none").Default("0"),
};

}  // namespace mascot
