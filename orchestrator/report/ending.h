#pragma once

#include <functional>
#include <optional>
#include <string>

#include "orchestrator/recording/run_folder.h"

namespace mascot {

/// What remains to be done after a run. Each step throws std::exception if it fails.
struct Ending {
  std::function<std::string(std::optional<int> exit)> summary;  ///< text of summary.json that states this exit code
  std::function<int()> draw;                                    ///< makes the pictures of it; returns an exit code
  std::function<void(const std::string& summary)> print;        ///< prints it
};

/// Writes summary.json, draws, prints. Returns the exit code: `exit`, that of the run, unless it is 0 and a step failed
/// (1) or drawing returned another. Says on stderr what failed. The exit code in summary.json is the one returned:
/// until it is known the file states none, and after a failure to write it none, or there is no file.
int EndRun(const RunFolder& folder, int exit, const Ending& ending);

}  // namespace mascot
