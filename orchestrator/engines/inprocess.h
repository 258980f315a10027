#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// The other engine: the same World and Agents as the processes run, in one thread, without DDS. `sinks` get the
/// states of every tick and the commands that answered them, in their order. `go_on` is asked once a tick; the run ends
/// early, in order, when it says no.
EngineResult RunInProcess(const Experiment& experiment, const std::vector<RowSink*>& sinks,
                          const std::function<bool()>& go_on);

}  // namespace mascot
