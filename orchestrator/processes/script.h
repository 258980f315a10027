#pragma once

#include <string>
#include <vector>

#include "bus/stop_signal.h"

namespace mascot {

/// Runs a script of scripts/, found beside this program, with these arguments. Returns its exit code, or 128 + the
/// signal that `stop` heard meanwhile, which ends it.
int RunScript(const std::string& script, const std::vector<std::string>& arguments, StopSignal& stop);

}  // namespace mascot
