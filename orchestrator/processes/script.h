#pragma once

#include <string>
#include <vector>

#include "bus/stop_signal.h"

namespace mascot {

/// Runs the Python script `script` of scripts/ (installed or in the source tree) with `arguments`. Returns its exit
/// code, or 128 + the signal that ended it. A signal that `stop` receives meanwhile ends the script. Throws
/// std::runtime_error if the script is missing or cannot be started.
int RunScript(const std::string& script, const std::vector<std::string>& arguments, StopSignal& stop);

}  // namespace mascot
