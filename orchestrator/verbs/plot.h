#pragma once

#include <filesystem>

#include "system/stop_signal.h"

namespace mascot {

/// Plots a run folder with scripts/plot.py. Returns the exit code of the script, or 128 + the signal that ended it (as
/// RunScript).
int PlotRun(const std::filesystem::path& folder, bool show, StopSignal& stop);

}  // namespace mascot
