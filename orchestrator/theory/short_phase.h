#pragma once

#include <optional>
#include <string>

#include "orchestrator/theory/theory.h"

namespace mascot {

/// The time from which on predictions about the end of a phase hold. If there are several such times, the law's own
/// counts. A time of modes, which is not that of the experiment's start, is only a hint, and is taken as a bound.
/// Absent: the predictions hold at any time, or theory does not know since when.
std::optional<HoldsFrom> WhenItHolds(const Prediction& prediction);
/// The warning of a phase that ends before this time; empty: it does not.
std::string ShortPhaseWarning(const Experiment& phase, bool is_last, const Prediction& prediction);

}  // namespace mascot
