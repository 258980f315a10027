#pragma once

#include <string>
#include <vector>

#include "agent/python/metrics.h"
#include "orchestrator/live/server/address.h"
#include "orchestrator/live/server/steering.h"
#include "system/console.h"
#include "system/stop_signal.h"

namespace mascot {

/// Where a recording is shown, and to whom.
struct Showing {
  LiveAddress at;
  std::vector<std::string> allowed_origins = {};
  Steering steering;
  const PythonMetrics* metrics = nullptr;  ///< shown as curves; null: none
};

/// Serves the page of a run on its recording until a signal. Returns it; 0: an error of ours has ended the view.
/// `words` begin the message of a ConfigError, thrown if no port can be had. Throws what RecordedRun throws.
int ShowRecording(const std::string& run, const Showing& showing, const std::string& words, StopSignal& stop,
                  Console& console);

}  // namespace mascot
