#pragma once

#include <vector>

#include "agent/laws/laws.h"

namespace mascot {

/// Turns a law's predictions of its figures (LawEntry::predict) into those that may be printed: rounding is added to
/// bounds, and noted beside values; bounds that say nothing, because they are no better than LawFigure::least or ::most
/// or are not finite, are removed, with the reason.
void Complete(const Experiment& experiment, const LawEntry& law, std::vector<PredictedFigure>& figures);

}  // namespace mascot
