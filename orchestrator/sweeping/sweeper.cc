#include "orchestrator/sweeping/sweeper.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "agent/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/processes/worker_pool.h"
#include "orchestrator/report/summary.h"
#include "orchestrator/sweeping/metrics.h"
#include "orchestrator/sweeping/table.h"
#include "orchestrator/theory/theory.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

/// Experiment file and plan of a sweep.
struct Sweep {
  const std::string& name;
  const std::string& text;
  const SweepPlan& plan;

  Experiment Load(std::size_t run) const {
    const Section document = Section::FromText(text, name, plan[run].overrides);
    Experiment experiment = LoadExperiment(document, std::filesystem::path(name).stem().string());
    if (experiment.run.mode == Mode::kRealtime)
      throw ConfigError({"sweep: expected run.mode = \"lockstep\", got \"realtime\""});
    return experiment;
  }
};

std::vector<std::string> NamesOfLaws(const Experiment& experiment) {
  std::vector<std::string> names;
  for (const LawEntry* law : LawsIn(experiment)) names.emplace_back(law->name);
  return names;
}

/// Executes one run. Returns the cells of its metric columns. Throws ConfigError if the experiment is not valid, and
/// std::runtime_error if the run fails.
std::map<std::string, std::string> FlyOne(const Sweep& sweep, std::size_t run) {
  const Experiment experiment = sweep.Load(run);
  const Prediction prediction = Predict(experiment);
  RunMeter meter(experiment);
  const EngineResult result = RunInProcess(experiment, {&meter}, [] { return true; });
  if (!result.failure.empty()) throw std::runtime_error(result.failure);
  const RunFacts facts{.engine = "inprocess"};
  return SweepMetrics(SummaryJson(experiment, prediction, meter, result, facts),
                      SweepMetricNames(NamesOfLaws(experiment)));
}

/// Work of the pool for a sweep of n runs: task k < n executes run k and returns its metric cells as JSON; task n + k
/// only reads and checks the experiment of run k and returns it resolved.
WorkerPool::Work WorkOf(const Sweep& sweep) {
  return [sweep](std::size_t task) -> std::string {
    if (task >= sweep.plan.size()) return sweep.Load(task - sweep.plan.size()).resolved;
    return nlohmann::json(FlyOne(sweep, task)).dump();
  };
}

struct Interrupted {
  int signal;
};

/// Throws Interrupted if a signal has come.
void ThrowIfInterrupted(StopSignal& stop) {
  if (const int signal = stop.Within(std::chrono::nanoseconds::zero()); signal != 0) throw Interrupted{signal};
}

/// Returns the first valid experiment of the sweep, resolved. Throws ConfigError with the mistakes of the first run if
/// no run is valid.
std::string FirstValid(const Sweep& sweep, WorkerPool& pool, StopSignal& stop) {
  std::string mistakes;
  for (std::size_t run = 0; run < sweep.plan.size(); ++run) {
    pool.Start(sweep.plan.size() + run);
    std::optional<WorkerPool::Done> done;
    while (!done) {
      done = pool.Wait(std::chrono::milliseconds(100));
      ThrowIfInterrupted(stop);
    }
    if (done->failure.empty()) return done->answer;
    if (mistakes.empty()) mistakes = done->failure;
  }
  throw ConfigError({mistakes});
}

class Progress {
 public:
  Progress(std::size_t runs, std::size_t there, bool quiet) : runs_(runs), there_(there), console_(quiet) {
    if (there > 0) console_.Line(fmt::format("going on: {} of {} runs are in the table", there, runs));
  }
  ~Progress() { console_.EndProgress(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(std::size_t done, std::size_t failed) {
    const double elapsed_s = std::chrono::duration<double>(WallClock::now() - start_).count();
    const double left_s =
        done > 0 ? elapsed_s / static_cast<double>(done) * static_cast<double>(runs_ - there_ - done) : 0;
    console_.Progress(static_cast<double>(there_ + done) / static_cast<double>(runs_),
                      fmt::format("{} of {} runs | {} failed | {}{:.0f} s left", there_ + done, runs_, failed,
                                  done > 0 ? "about " : "", left_s));
  }

 private:
  std::size_t runs_, there_;
  Console console_;
  WallClock::time_point start_ = WallClock::now();
};

/// Cells of a row after the run number: values set, error, metrics.
SweepFile::Cells RowOf(const SweepPoint& point, const WorkerPool::Done& done, const std::vector<std::string>& metrics) {
  SweepFile::Cells cells;
  for (const Override& override : point.overrides) cells.push_back(override.value);
  cells.push_back(done.failure);
  std::map<std::string, std::string> measured;
  if (done.failure.empty()) nlohmann::json::parse(done.answer).get_to(measured);
  for (const std::string& metric : metrics) cells.push_back(measured[metric]);
  return cells;
}

/// Executes every run that is missing in the table. Updates `outcome` after each run, so that it is right even if a
/// signal ends this.
void ExecuteMissing(const SweepPlan& plan, const std::vector<std::string>& metrics, WorkerPool& pool, SweepFile& table,
                    bool quiet, StopSignal& stop, Sweeper::Outcome& outcome) {
  Progress progress(plan.size(), table.rows(), quiet);
  std::size_t next = 0;
  const auto skip_done = [&] {
    while (next < plan.size() && table.Has(next)) ++next;
    return next < plan.size();
  };
  while (skip_done() || pool.IsBusy()) {
    while (skip_done() && pool.HasIdle()) pool.Start(next++);
    if (const auto done = pool.Wait(std::chrono::milliseconds(100))) {
      table.Add(done->task, RowOf(plan[done->task], *done, metrics));
      ++outcome.flown;
      outcome.failed += !done->failure.empty();
    }
    progress.Show(outcome.flown, outcome.failed);
    ThrowIfInterrupted(stop);
  }
}

/// Metric columns of the table: those of the laws in its first valid experiment, and of the laws that it goes over.
std::vector<std::string> MetricsOf(const Sweep& sweep, const std::string& resolved) {
  const Experiment first = LoadExperiment(Section::FromText(resolved, sweep.name), "", /*checked=*/true);
  std::vector<std::string> laws = NamesOfLaws(first);
  for (std::size_t run = 0; run < sweep.plan.size(); ++run)
    for (const Override& override : sweep.plan[run].overrides)
      if (override.key == "law.name" && override.value.size() > 2)
        laws.push_back(override.value.substr(1, override.value.size() - 2));  // without quotation marks
  return SweepMetricNames(laws);
}

SweepFile::Cells ColumnsOf(const SweepPlan& plan, const std::vector<std::string>& metrics) {
  SweepFile::Cells columns{"run"};
  columns.insert(columns.end(), plan.keys().begin(), plan.keys().end());
  columns.push_back(kErrorColumn);
  columns.insert(columns.end(), metrics.begin(), metrics.end());
  return columns;
}

/// Throws ConfigError if `metric` is not one of `metrics`.
void CheckMetric(const std::string& metric, const std::vector<std::string>& metrics) {
  if (std::ranges::find(metrics, metric) != metrics.end()) return;
  const std::vector<std::string_view> views(metrics.begin(), metrics.end());
  const auto nearest = DidYouMean(metric, views);
  throw ConfigError({fmt::format("--plot: expected a column of the table, such as {}, got '{}'{}", kUsualMetric, metric,
                                 nearest ? " (did you mean \"" + *nearest + "\"?)" : "")});
}

/// Text that identifies the sweep of a table: the experiment file, the first valid experiment resolved (with the files
/// that it names), and what each run sets.
std::string PlanText(const Sweep& sweep, const std::string& resolved) {
  std::string text;
  for (std::size_t run = 0; run < sweep.plan.size(); ++run) {
    for (const Override& override : sweep.plan[run].overrides) text += override.key + "=" + override.value + " ";
    text += "\n";
  }
  return sweep.text + "\n# its first valid run\n" + resolved + "\n# runs of the sweep\n" + text;
}

}  // namespace

Sweeper::Sweeper(std::string name, std::string text, SweepPlan plan)
    : name_(std::move(name)), text_(std::move(text)), plan_(std::move(plan)) {}

Sweeper::Outcome Sweeper::Fly(const Options& options, StopSignal& stop) const {
  const Sweep sweep{name_, text_, plan_};
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  WorkerPool pool(options.jobs > 0 ? options.jobs : cores, WorkOf(sweep));
  Outcome outcome;
  try {
    const std::string first = FirstValid(sweep, pool, stop);
    const std::vector<std::string> metrics = MetricsOf(sweep, first);
    if (!options.metric.empty()) CheckMetric(options.metric, metrics);
    SweepFile table(options.out, ColumnsOf(plan_, metrics), PlanText(sweep, first), options.force);
    try {
      ExecuteMissing(plan_, metrics, pool, table, options.quiet, stop, outcome);
      table.Sort();
    } catch (const Interrupted& interrupted) {
      outcome.signal = interrupted.signal;
    }
    outcome.in_table = table.rows();
  } catch (const Interrupted& interrupted) {  // before the table was opened
    outcome.signal = interrupted.signal;
  }
  return outcome;
}

}  // namespace mascot
