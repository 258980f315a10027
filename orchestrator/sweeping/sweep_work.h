#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/python/environment.h"
#include "agent/python/metrics.h"
#include "experiment/experiment.h"
#include "orchestrator/sweeping/plan/law_axis.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/plan/run_laws.h"
#include "system/worker_pool.h"

namespace mascot {

/// Experiment file and plan of a sweep. All that this object refers to must outlive it.
struct Sweep {
  const std::string& name;  ///< path of the experiment file as typed
  const std::string& text;  ///< its contents
  const SweepPlan& plan;
  const LawAxis& laws;
  const MetricFile& metric_file;
  /// Made by each worker process for itself, when it needs them; null: there is no metric file.
  std::shared_ptr<std::optional<PythonMetrics>> own = {};

  /// The experiment of a run or a trial. Throws ConfigError if it is not valid, or runs in real time.
  Experiment Load(const SweepPoint& point) const;
};

/// What the check of an experiment finds without flying it.
struct CheckedRun {
  std::string resolved;
  std::vector<std::string> draws;  ///< DrawsOf()
  RunLaws laws;
  PythonNote python = {};
};

/// The tasks of the worker processes of a sweep of n runs: task k < n executes run k and answers with its metric cells;
/// the other tasks check a run or a trial, or list the user's metrics.
class SweepTasks {
 public:
  explicit SweepTasks(const SweepPlan& plan) : runs_(plan.size()), trials_(plan.TrialCount()) {}

  std::size_t CheckOfRun(std::size_t run) const { return runs_ + run; }
  std::size_t CheckOfTrial(std::size_t trial) const { return 2 * runs_ + trial; }
  std::size_t ListMetrics() const { return 2 * runs_ + trials_; }
  /// The run of a task that CheckOfRun() gave.
  std::size_t RunOfCheck(std::size_t task) const { return task - runs_; }

 private:
  std::size_t runs_, trials_;
};

/// A function that executes the tasks of a sweep in a worker process. Its answers are JSON.
WorkerPool::Work WorkOf(const Sweep& sweep);
CheckedRun CheckedRunFrom(const std::string& answer);
std::vector<PythonMetric> MetricsFrom(const std::string& answer);

}  // namespace mascot
