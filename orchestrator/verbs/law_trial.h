#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// What is found out about laws of users by flying them ahead of the run.
struct LawTrial {
  /// Where the same experiment gave other commands when it was flown again, and what that may come from; empty: it did
  /// not, or nothing was flown.
  std::string difference;
  /// What is dubious, with `difference`.
  std::vector<std::string> warnings;
};

/// Flies the beginning of the experiment twice, on ideal bodies, each time in a new process, and compares all commands
/// bit by bit. Takes a few seconds at most, if the laws let themselves be interrupted. Nothing is flown if no agent
/// has a law of a user.
LawTrial TryLaws(const Experiment& experiment);

/// The argument by which this program, as another process, flies such a beginning.
inline constexpr const char* kTrialFlight = "--trial-flight";
/// What it then does: flies the resolved experiment on standard input, and writes what TryLaws() wants to know to the
/// descriptor of this number. Returns the exit code.
int FlyTrial(std::string_view descriptor);

}  // namespace mascot
