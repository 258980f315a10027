#pragma once

#include <filesystem>

namespace mascot {

/// Makes the pictures of a run folder with scripts/plot.py, found beside this program. Returns its exit code.
int PlotRun(const std::filesystem::path& folder, bool show);

}  // namespace mascot
