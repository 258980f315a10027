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

/// The largest share, up to 1, of their stiffness with which modes of `moves` decay on quadrotors like this one: the
/// low-level stack and the body, sampled. 0: they do not decay with any.
double StableShare(const Experiment& experiment, const AgentConfig& quadrotor, const LinearAgent& moves,
                   std::span<const LinearMode> modes);
/// Returns whether the modes of agents `ids`, who all move like `moves`, decay also because these turn first; else adds
/// a warning. True if they are not quadrotors that are alike. `key`: the gain, now `gain`, to which the stiffness of
/// all modes is proportional.
bool JudgeTurning(const Experiment& experiment, std::span<const int> ids, const LinearAgent& moves,
                  std::span<const LinearMode> modes, std::string_view key, double gain, Prediction& prediction);
/// The same for a law that wants velocities and has these rates. True also if agents do not hear all in time.
bool JudgeTurning(const Experiment& experiment, const LawRates& rates, Prediction& prediction);

}  // namespace mascot
