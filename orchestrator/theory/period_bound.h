#pragma once

#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// The longest control period below which a team whose agents differ decays, on a graph that does not change and
/// without delays, by the eigenvalues of its map; 0: it does at no period.
double PeriodBound(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline);
/// That many eigenvalue problems are quick enough.
bool PeriodBoundIsKnown(const Experiment& experiment);

}  // namespace mascot
