#pragma once

#include <cstdint>
#include <functional>

#include "experiment/experiment.h"
#include "orchestrator/engine.h"
#include "orchestrator/run_writer.h"

namespace mascot {

/// The other engine: the same World and Agents as the processes run, in one thread, without DDS. `go_on` is
/// asked once a tick; the run ends early, in order, when it says no.
EngineResult RunInProcess(Experiment& experiment, RunWriter& writer,
                          const std::function<bool(std::int64_t tick)>& go_on);

}  // namespace mascot
