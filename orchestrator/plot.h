#pragma once

#include <filesystem>

#include "idl/stop_signal.h"

namespace mascot {

/// Makes the pictures of a run folder with scripts/plot.py, found beside this program. Returns its exit code, or
/// 128 + the signal that `stop` heard meanwhile, which ends it.
int PlotRun(const std::filesystem::path& folder, bool show, StopSignal& stop);

}  // namespace mascot
