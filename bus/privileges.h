#pragma once

#include "experiment/experiment.h"

namespace mascot {

/// Gives this process what [run] asks for it: scheduler, pin_cores, lock_memory; to all of its threads, those of the
/// library too. In lockstep, unless asked for more, they run as SCHED_BATCH. `place`: which of the cores that it may
/// use, round again. What is not permitted is said on stderr, with the key, and the run goes on without.
void TakePrivileges(const Experiment& experiment, int place);

}  // namespace mascot
