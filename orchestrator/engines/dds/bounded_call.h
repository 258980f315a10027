#pragma once

#include <chrono>
#include <functional>

#include "system/stop_signal.h"

namespace mascot {

/// Makes a call that may hang, in a thread of its own. Returns whether it has returned within `limit` and before a
/// signal; if not, the thread goes on, and nothing that it uses may be destroyed. Throws what the call throws, and
/// std::system_error if no thread can be started.
bool ReturnsWithin(std::chrono::milliseconds limit, std::function<void()> call, StopSignal& stop);

}  // namespace mascot
