#pragma once

#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// The control period (s) up to which a team of different agents decays on a constant graph without delays, from the
/// eigenvalues of its sampled map. 0: it does not decay at any period.
double PeriodBound(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline);
/// Whether the team is small enough to compute PeriodBound, which solves many eigenvalue problems.
bool PeriodBoundIsKnown(const Experiment& experiment);

}  // namespace mascot
