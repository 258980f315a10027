#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "orchestrator/sweeping/sweep_work.h"
#include "system/stop_signal.h"
#include "system/worker_pool.h"

namespace mascot {

/// Thrown where a signal ends a sweep early.
struct Interrupted {
  int signal;
};

/// Throws Interrupted if a signal has come.
void ThrowIfInterrupted(StopSignal& stop);

/// Looks at the runs of a sweep before they fly. Throws Interrupted if a signal comes.
class SweepChecks {
 public:
  /// All arguments must outlive this object. `pool` executes WorkOf(sweep).
  SweepChecks(const Sweep& sweep, WorkerPool& pool, StopSignal& stop)
      : sweep_(sweep), tasks_(sweep.plan), pool_(pool), stop_(stop) {}

  /// The first valid experiment of the sweep. Throws ConfigError with the mistakes of the first run if no run is valid;
  /// with `first_alone`, if that one is not.
  CheckedRun FirstValid(bool first_alone);
  /// The laws of every run, from a look at the first of those that are alike. Numbers count only where they decide
  /// about laws, or where a run is not valid: another number may be.
  KnownLaws Laws();
  /// The user's metrics. Throws ConfigError for mistakes in their file, or if a name is that of another column.
  std::vector<PythonMetric> Metrics(const std::vector<std::string>& other_columns);
  /// Throws ConfigError with the mistakes of the first trial of the plan that is not valid.
  void CheckTrials();
  /// Throws ConfigError if the sweep goes over several seeds, but no run depends on its seed. `first`: FirstValid().
  void CheckSeeds(const CheckedRun& first);

 private:
  const Sweep& sweep_;
  SweepTasks tasks_;
  WorkerPool& pool_;
  StopSignal& stop_;
};

}  // namespace mascot
