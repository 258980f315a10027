#pragma once

#include <filesystem>

#include "bus/stop_signal.h"

namespace mascot {

/// Makes the pictures of a run folder with scripts/plot.py. Returns the
/// script's exit code, or 128 + the signal that `stop` heard meanwhile.
int PlotRun(const std::filesystem::path& folder, bool show, StopSignal& stop);

}  // namespace mascot
