#pragma once

#include <vector>

#include "bus/stop_signal.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Runs the experiment as processes on a DDS domain of its own: one physics server, one agent each (those
/// marked external are waited for), recorded here: `sinks` get every row. Returns
/// when every process has ended and nothing of the run is left in shared memory.
EngineResult RunOverDds(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
                        Console& console, StopSignal& stop);

}  // namespace mascot
