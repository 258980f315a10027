#pragma once

#include <functional>
#include <optional>
#include <string>

#include "orchestrator/recording/run_folder.h"

namespace mascot {

/// What remains to be done after a run. Each step throws std::exception if it fails.
struct Ending {
  std::function<std::string(std::optional<int> exit)> summary;  ///< text of summary.json that states this exit code
  std::function<int()> draw;                                    ///< makes the pictures of the run; returns an exit code
  std::function<void(const std::string& summary)> print;  ///< prints this text of summary.json, for people or as it is
};

/// Writes summary.json, draws, prints. Returns the exit code: `exit`, that of the run, unless it is 0 and a step failed
/// (1) or drawing returned another. Says on stderr what failed. The exit code in summary.json is the one that is
/// returned. Until it is known, the file states none; if the file cannot be written with it, the file still states
/// none, or does not exist.
int EndRun(const RunFolder& folder, int exit, const Ending& ending);

}  // namespace mascot
