#pragma once

#include <cstddef>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "orchestrator/sweeping/sweep_work.h"
#include "system/stop_signal.h"
#include "system/worker_pool.h"

namespace mascot {

/// Thrown when a signal ends a sweep early.
struct Interrupted {
  int signal;
};

/// Throws Interrupted if a signal has come.
void ThrowIfInterrupted(StopSignal& stop);

/// Checks the runs of a sweep before they fly. All functions throw Interrupted if a signal comes.
class SweepChecks {
 public:
  /// All arguments must outlive this object. `pool` executes WorkOf(sweep).
  SweepChecks(const Sweep& sweep, WorkerPool& pool, StopSignal& stop)
      : sweep_(sweep), tasks_(sweep.plan), pool_(pool), stop_(stop) {}

  /// The first run of the sweep that is a valid experiment. Throws ConfigError with the mistakes of the first run if no
  /// run is valid; with `first_alone`, already if the first run is not.
  CheckedRun FirstValid(bool first_alone);
  /// The laws of every run, from checks of the representatives. Runs that differ in numbers alone count as alike,
  /// unless numbers decide which laws a run has, or a representative is not valid: with other numbers it may be.
  KnownLaws Laws();
  /// The user's metrics. Throws ConfigError for mistakes in their file, or if a metric has the name of one of
  /// `other_columns`.
  std::vector<PythonMetric> Metrics(const std::vector<std::string>& other_columns);
  /// Throws ConfigError with the mistakes of the first trial of the plan that is not valid.
  void CheckTrials();
  /// Throws ConfigError with the mistakes of all rows of a table, each once: what several rows get wrong in the same
  /// column is said of the first of them.
  void CheckRows();
  /// Throws ConfigError if the sweep goes over several seeds, but no run depends on its seed. `first`: FirstValid().
  void CheckSeeds(const CheckedRun& first);

 private:
  /// The mistakes of the trials that are not valid, each as text, by the number of the trial.
  std::map<std::size_t, std::string> MistakesOfTrials();

  const Sweep& sweep_;
  SweepTasks tasks_;
  WorkerPool& pool_;
  StopSignal& stop_;
};

}  // namespace mascot
