#pragma once

#include "experiment/experiment.h"

namespace mascot {

/// Applies run.scheduler, run.pin_cores and run.lock_memory to all threads of this process, those of libraries
/// included. In lockstep, threads run as SCHED_BATCH unless run.scheduler is "fifo". With pin_cores, the process takes
/// the allowed core number `place`, modulo their number. A setting that the system does not permit is reported on
/// stderr with its key, and the run goes on without it.
void ApplyScheduling(const Experiment& experiment, int place);

}  // namespace mascot
