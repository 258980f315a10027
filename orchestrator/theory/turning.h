#pragma once

#include <span>
#include <string_view>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/modes.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

// Quadrotors turn before they accelerate along x and y. Errors are taken to be small: no limit is reached.

/// The largest share, up to 1, of its stiffness with which each mode of `moves` decays on quadrotors like this one,
/// whose low-level stack and body are sampled. 0: the modes do not decay with any share.
double StableShare(const Experiment& experiment, const AgentConfig& quadrotor, const LinearAgent& moves,
                   std::span<const LinearMode> modes);
/// Returns whether the modes of agents `ids`, which all move like `moves`, also decay on bodies that turn first; else
/// adds a warning. True if the agents are not equal quadrotors. `key` is the key of the gain, now `gain`, to which the
/// stiffness of all modes is proportional.
bool JudgeTurning(const Experiment& experiment, std::span<const int> ids, const LinearAgent& moves,
                  std::span<const LinearMode> modes, std::string_view key, double gain, Prediction& prediction);
/// The same for a law that wants velocities and has these rates. True also if agents do not hear all others in time.
bool JudgeTurning(const Experiment& experiment, const LawRates& rates, Prediction& prediction);

}  // namespace mascot
