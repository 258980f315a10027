#pragma once

#include "agent/laws.h"
#include "experiment/experiment.h"

namespace mascot {

inline constexpr LawParameter kVelocityConsensusParameters[] = {
    {"p_gain", "1.0", "[0, 1000], 1/s", "pull towards each neighbour, times its weight"},
    {"leader", "0", "0..N", "agent that leads and stands still; 0: none"},
};

/// Reads p_gain.
double ReadVelocityConsensus(LawConfig& law);

}  // namespace mascot
