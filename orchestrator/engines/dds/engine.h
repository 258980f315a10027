#pragma once

#include <vector>

#include "bus/stop_signal.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// Runs the experiment as separate processes in a DDS domain of its own: a physics server and the agent processes.
/// External agents are waited for, not started. The calling process records: `sinks` get every row, in tick order.
/// Returns when every child process has ended and the run's shared memory is removed. A failure
/// is reported in the result.
EngineResult RunOverDds(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
                        Console& console, StopSignal& stop);

}  // namespace mascot
