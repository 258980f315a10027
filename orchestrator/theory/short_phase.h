#pragma once

#include <optional>
#include <string>

#include "orchestrator/theory/theory.h"

namespace mascot {

/// From when on holds what theory says of the end of a phase. Of several times for one thing the law's own counts; a
/// time of modes, which is not from the experiment's start, is no more than a hint, and taken as a bound. Absent: it
/// holds at any time, or theory does not know.
std::optional<HoldsFrom> WhenItHolds(const Prediction& prediction);
/// The warning of a phase that ends before that; empty: it does not.
std::string ShortPhaseWarning(const Experiment& phase, bool is_last, const Prediction& prediction);

}  // namespace mascot
