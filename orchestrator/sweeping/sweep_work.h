#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/python/metrics.h"
#include "experiment/experiment.h"
#include "orchestrator/sweeping/plan/law_axis.h"
#include "orchestrator/sweeping/plan/plan.h"
#include "orchestrator/sweeping/plan/run_laws.h"
#include "system/worker_pool.h"

namespace mascot {

/// A Python file with the user's own metrics, and its contents, read once.
struct MetricFile {
  std::string path;  ///< empty: there is none
  std::string text;
};

/// Experiment file and plan of a sweep. All that it refers to must outlive it.
struct Sweep {
  const std::string& name;  ///< path of the experiment file as typed
  const std::string& text;  ///< its contents
  const SweepPlan& plan;
  const LawAxis& laws;
  const MetricFile& metric_file;
  std::shared_ptr<std::optional<PythonMetrics>> own = {};  ///< made by each worker for itself, when it needs them

  /// Throws ConfigError if it is no valid experiment, or one in real time.
  Experiment Load(const SweepPoint& point) const;
};

/// What is found out about an experiment without flying it.
struct CheckedRun {
  std::string resolved;
  std::vector<std::string> draws;  ///< DrawsOf()
  RunLaws laws;
};

/// The tasks of the worker processes of a sweep of n runs: task k < n executes run k and answers with its metric cells,
/// the others answer with what they look at.
class SweepTasks {
 public:
  explicit SweepTasks(const SweepPlan& plan) : runs_(plan.size()), trials_(plan.trials().size()) {}

  std::size_t CheckOfRun(std::size_t run) const { return runs_ + run; }
  std::size_t CheckOfTrial(std::size_t trial) const { return 2 * runs_ + trial; }
  std::size_t ListMetrics() const { return 2 * runs_ + trials_; }
  /// The run of a task that CheckOfRun() gave.
  std::size_t RunOfCheck(std::size_t task) const { return task - runs_; }

 private:
  std::size_t runs_, trials_;
};

/// Executes the tasks of a sweep. Answers are JSON.
WorkerPool::Work WorkOf(const Sweep& sweep);
CheckedRun CheckedRunFrom(const std::string& answer);
std::vector<PythonMetric> MetricsFrom(const std::string& answer);

}  // namespace mascot
