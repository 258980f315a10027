#pragma once

#include <cstdint>
#include <functional>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/recording/decoded_row.h"

namespace mascot {

/// The other engine: the same World and Agents as the processes run, in one thread, without DDS. `on_tick` gets the
/// states of every tick and the commands that answered them. `go_on` is asked once a tick; the run ends early, in
/// order, when it says no.
EngineResult RunInProcess(Experiment& experiment,
                          const std::function<void(std::int64_t tick, const DecodedRow& row)>& on_tick,
                          const std::function<bool(std::int64_t tick)>& go_on);

}  // namespace mascot
