#include "orchestrator/sweeping/sweeper.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "agent/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/processes/worker_pool.h"
#include "orchestrator/report/summary.h"
#include "orchestrator/sweeping/law_axis.h"
#include "orchestrator/sweeping/metrics.h"
#include "orchestrator/sweeping/outcomes.h"
#include "orchestrator/sweeping/run_arrays.h"
#include "orchestrator/sweeping/run_laws.h"
#include "orchestrator/sweeping/table.h"
#include "orchestrator/theory/draws.h"
#include "orchestrator/theory/theory.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;
using WallClock = std::chrono::steady_clock;

constexpr TimeLimit kMetricLimit{60, "the limit of a metric"};

/// Experiment file and plan of a sweep.
struct Sweep {
  const std::string& name;
  const std::string& text;
  const SweepPlan& plan;
  const LawAxis& laws;
  const Sweeper::MetricFile& metric_file;
  std::shared_ptr<std::optional<PythonMetrics>> own = {};  ///< made by each worker for itself, when it needs them

  Experiment Load(const SweepPoint& point) const {
    const Section document = Section::FromText(text, name, laws.Fit(point.overrides));
    Experiment experiment = LoadExperiment(document, std::filesystem::path(name).stem().string());
    if (experiment.run.mode == Mode::kRealtime)
      throw ConfigError({"sweep: expected run.mode = \"lockstep\", got \"realtime\""});
    return experiment;
  }
};

/// The metrics of the user's file.
const PythonMetrics& OwnMetrics(const Sweep& sweep) {
  const fs::path path = sweep.metric_file.path;
  if (!*sweep.own) sweep.own->emplace(sweep.metric_file.text, path.filename(), path.parent_path(), kMetricLimit);
  return **sweep.own;
}

/// Adds the cells of the user's metrics.
void AddOwn(const PythonMetrics& own, const RunArrays& arrays, std::map<std::string, std::string>& cells) {
  const std::vector<std::optional<double>> numbers = own.Of(arrays.All());
  for (std::size_t k = 0; k < numbers.size(); ++k)
    cells[own.list()[k].name] = numbers[k] ? ShortestFloat(*numbers[k]) : "";
}

/// Executes one run. Returns the cells of its metric columns. Throws ConfigError if the experiment is not valid, and
/// std::runtime_error if the run fails.
std::map<std::string, std::string> FlyOne(const Sweep& sweep, std::size_t run) {
  const Experiment experiment = sweep.Load(sweep.plan[run]);
  const Prediction prediction = Predict(experiment);
  RunMeter meter(experiment);
  RunArrays arrays(experiment);
  std::vector<RowSink*> sinks{&meter};
  if (sweep.own) sinks.push_back(&arrays);
  const EngineResult result = RunInProcess(experiment, sinks, [] { return true; });
  if (!result.failure.empty()) throw std::runtime_error(result.failure);
  const RunFacts facts{.engine = "inprocess"};
  auto cells = SweepMetrics(SummaryJson(experiment, prediction, meter, result, facts),
                            SweepMetricNames(LawsAtTheEnd(experiment).names));
  if (sweep.own) AddOwn(OwnMetrics(sweep), arrays, cells);
  return cells;
}

/// What is found out about an experiment without flying it.
struct Looked {
  std::string resolved;
  std::vector<std::string> draws;  ///< DrawsOf()
  RunLaws laws;
};

nlohmann::json ToJson(const RunLaws& laws) {
  return {{"team", laws.team},
          {"team_agrees", laws.team_agrees},
          {"names", laws.names},
          {"depend_on_numbers", laws.depend_on_numbers}};
}

RunLaws RunLawsFrom(const nlohmann::json& json) {
  return {json["team"], json["team_agrees"], json["names"], json["depend_on_numbers"]};
}

std::size_t TaskOfMetrics(const Sweep& sweep) { return 2 * sweep.plan.size() + sweep.plan.trials().size(); }

/// Work of the pool for a sweep of n runs: task k < n executes run k and returns its metric cells; task n + k only
/// looks at run k, and task 2 n + k at trial k of the plan. Answers are JSON.
WorkerPool::Work WorkOf(const Sweep& sweep) {
  return [sweep](std::size_t task) -> std::string {
    const std::size_t runs = sweep.plan.size();
    if (task < runs) return nlohmann::json(FlyOne(sweep, task)).dump();
    if (task == TaskOfMetrics(sweep)) {
      nlohmann::json list = nlohmann::json::array();
      for (const PythonMetric& metric : OwnMetrics(sweep).list()) list.push_back({metric.name, metric.unit});
      return list.dump();
    }
    const Experiment experiment =
        sweep.Load(task < 2 * runs ? sweep.plan[task - runs] : sweep.plan.trials()[task - 2 * runs]);
    const nlohmann::json laws = ToJson(LawsAtTheEnd(experiment));
    return nlohmann::json({{"resolved", experiment.resolved}, {"draws", DrawsOf(experiment)}, {"laws", laws}}).dump();
  };
}

Looked LookedFrom(const std::string& answer) {
  const nlohmann::json json = nlohmann::json::parse(answer);
  return {json["resolved"], json["draws"], RunLawsFrom(json["laws"])};
}

struct Interrupted {
  int signal;
};

/// Throws Interrupted if a signal has come.
void ThrowIfInterrupted(StopSignal& stop) {
  if (const int signal = stop.Within(std::chrono::nanoseconds::zero()); signal != 0) throw Interrupted{signal};
}

/// Executes tasks, several at a time, and hands each to `take` as it is done, in any order, until that returns false.
void ExecuteTasks(std::span<const std::size_t> tasks, WorkerPool& pool, StopSignal& stop,
                  const std::function<bool(const WorkerPool::Done&)>& take) {
  bool go_on = true;
  for (auto next = tasks.begin(); (go_on && next != tasks.end()) || pool.IsBusy();) {
    while (go_on && next != tasks.end() && pool.HasIdle()) pool.Start(*next++);
    if (const auto done = pool.Wait(std::chrono::milliseconds(100)); done && go_on) go_on = take(*done);
    ThrowIfInterrupted(stop);
  }
}

/// Returns the first valid experiment of the sweep. Throws ConfigError with the mistakes of the first run if no run is
/// valid; with `first_alone`, if that one is not.
Looked FirstValid(const Sweep& sweep, bool first_alone, WorkerPool& pool, StopSignal& stop) {
  std::string mistakes;
  std::optional<Looked> valid;
  for (std::size_t run = 0; run < (first_alone ? 1 : sweep.plan.size()) && !valid; ++run) {
    const std::size_t task = sweep.plan.size() + run;
    ExecuteTasks({&task, 1}, pool, stop, [&](const WorkerPool::Done& done) {
      if (done.failure.empty()) valid = LookedFrom(done.answer);
      if (mistakes.empty()) mistakes = done.failure;
      return true;
    });
  }
  if (!valid) throw ConfigError({mistakes});
  return *valid;
}

/// The laws of every run, from a look at the first of those that are alike. Numbers count only where they decide about
/// laws, or where a run is not valid: another number may be.
SweepLaws LookAtLaws(const Sweep& sweep, WorkerPool& pool, StopSignal& stop) {
  SweepLaws::Known known;
  SweepPlan::Firsts firsts;
  bool by_numbers = false;
  for (const auto alike : {SweepPlan::Alike::kInWords, SweepPlan::Alike::kInValues}) {
    firsts = sweep.plan.FirstsAlike(alike);
    std::vector<std::size_t> tasks;
    for (std::size_t run = 0; run < sweep.plan.size(); ++run)
      if (firsts[run] == run && !known.contains(run)) tasks.push_back(sweep.plan.size() + run);
    ExecuteTasks(tasks, pool, stop, [&](const WorkerPool::Done& done) {
      const bool valid = done.failure.empty();
      if (valid) known[done.task - sweep.plan.size()] = LookedFrom(done.answer).laws;
      by_numbers = by_numbers || !valid || known[done.task - sweep.plan.size()].depend_on_numbers;
      return true;
    });
    if (!by_numbers) break;
  }
  return {sweep.plan, std::move(firsts), std::move(known)};
}

/// The user's metrics. Throws ConfigError for mistakes in their file, or if a name is that of another column.
std::vector<PythonMetric> ListMetrics(const Sweep& sweep, const std::vector<std::string>& others, WorkerPool& pool,
                                      StopSignal& stop) {
  std::vector<PythonMetric> list;
  if (!sweep.own) return list;
  const std::size_t task = TaskOfMetrics(sweep);
  ExecuteTasks({&task, 1}, pool, stop, [&](const WorkerPool::Done& done) {
    if (!done.failure.empty()) throw ConfigError({"--metric: " + done.failure});
    for (const auto& metric : nlohmann::json::parse(done.answer)) list.push_back({metric[0], metric[1]});
    return true;
  });
  for (const PythonMetric& metric : list)
    if (std::ranges::find(others, metric.name) != others.end())
      throw ConfigError({"--metric: expected names that no other column has, got '" + metric.name + "'"});
  return list;
}

/// The values in which a trial differs from the first run: "law.name = rendezvous".
std::string DifferenceOf(const SweepPoint& trial, const SweepPoint& first) {
  for (std::size_t k = 0; k < trial.overrides.size(); ++k)
    if (trial.overrides[k].value != first.overrides[k].value)
      return trial.overrides[k].key + " = " + trial.overrides[k].value;
  return "";
}

/// Throws ConfigError with the mistakes of the first trial that is not valid.
void CheckTrials(const Sweep& sweep, WorkerPool& pool, StopSignal& stop) {
  std::vector<std::size_t> tasks(sweep.plan.trials().size());
  std::iota(tasks.begin(), tasks.end(), 2 * sweep.plan.size());
  std::map<std::size_t, std::string> mistakes;
  ExecuteTasks(tasks, pool, stop, [&](const WorkerPool::Done& done) {
    if (!done.failure.empty()) mistakes[done.task - tasks.front()] = done.failure;
    return true;
  });
  if (mistakes.empty()) return;
  const auto& [trial, text] = *mistakes.begin();
  throw ConfigError({fmt::format("sweep: the first run with {}: {} (--force flies the other runs)",
                                 DifferenceOf(sweep.plan.trials()[trial], sweep.plan[0]), text)});
}

/// Throws ConfigError if the sweep goes over several seeds, but no run depends on its seed.
void CheckSeeds(const Sweep& sweep, const Looked& first, WorkerPool& pool, StopSignal& stop) {
  std::vector<std::size_t> runs = sweep.plan.WithFirstSeed();
  if (runs.empty() || !first.draws.empty()) return;
  for (std::size_t& run : runs) run += sweep.plan.size();
  bool draws = false;
  ExecuteTasks(runs, pool, stop, [&](const WorkerPool::Done& done) {
    draws = done.failure.empty() && !LookedFrom(done.answer).draws.empty();
    return !draws;
  });
  if (!draws)
    throw ConfigError(
        {fmt::format("sweep: expected one run.seed, because every seed gives the same run (nothing is "
                     "drawn: no places, edges, loss, jitter, noise, gusts or lies at random, no law that "
                     "draws), got {} (--force flies them all)",
                     sweep.plan.size() / runs.size())});
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

SweepFile::Cells ColumnsOf(const SweepPlan& plan, const std::vector<std::string>& metrics) {
  SweepFile::Cells columns{"run"};
  columns.insert(columns.end(), plan.keys().begin(), plan.keys().end());
  columns.push_back(kErrorColumn);
  columns.insert(columns.end(), metrics.begin(), metrics.end());
  return columns;
}

/// Throws ConfigError if `metric` is not one of `metrics`.
void CheckMetric(const std::string& metric, const std::vector<std::string>& metrics) {
  const auto place = std::ranges::find(metrics, metric);
  if (metrics.end() - place > static_cast<std::ptrdiff_t>(kWallClockColumns)) return;
  if (place != metrics.end())
    throw ConfigError({"--plot: expected a column of which there are statistics, got '" + metric +
                       "', which depends on the machine"});
  const std::vector<std::string_view> views(metrics.begin(), metrics.end());
  const auto whole =
      std::ranges::find_if(metrics, [&](const std::string& name) { return name.ends_with("." + metric); });
  const auto nearest = whole != metrics.end() ? std::optional(*whole) : DidYouMean(metric, views);
  throw ConfigError({fmt::format("--plot: expected a column of the table, such as {}, got '{}'{}", kUsualMetric, metric,
                                 nearest ? " (did you mean \"" + *nearest + "\"?)" : "")});
}

/// The end of the text that identifies a sweep: what its runs set.
std::string RunsText(const Sweep& sweep) { return "\n# its runs\n" + sweep.plan.Text(); }

/// Text that identifies the sweep of a table: the experiment file, the first valid experiment resolved (with the files
/// that it names), the user's metrics, and what each run sets.
std::string PlanText(const Sweep& sweep, const std::string& resolved) {
  const std::string own = sweep.own ? "\n# its own metrics\n" + sweep.metric_file.text : "";
  return sweep.text + "\n# its first valid run\n" + resolved + own + RunsText(sweep);
}

/// Whether a table of this sweep was begun: it is then gone on with, also if --force has begun it.
bool IsBegun(const Sweep& sweep, const std::string& table) {
  const std::string plan = SweepFile::PlanBeside(table);
  return plan.starts_with(sweep.text) && plan.ends_with(RunsText(sweep));
}

/// Writes the statistics of a complete table beside it. Returns what there is to say on the terminal.
std::vector<std::string> Conclude(const SweepPlan& plan, const SweepLaws& laws, const std::vector<std::string>& metrics,
                                  const SweepFile& table, const std::string& out) {
  Outcomes outcomes(plan, laws, ColumnsOf(plan, metrics));
  table.ForEachRow([&](const SweepFile::Cells& cells) { outcomes.Add(cells); });
  const std::span<const std::string> repeatable = std::span(metrics).first(metrics.size() - kWallClockColumns);
  const fs::path path = StatisticsBeside(out);
  WholeFile statistics(path.string());
  outcomes.WriteStatistics(repeatable, [&](std::string_view line) { statistics.Write(line); });
  statistics.Commit();
  std::vector<std::string> lines = outcomes.Lines();
  lines.push_back("statistics over seeds: " + path.string());
  return lines;
}

}  // namespace

std::filesystem::path FileBeside(std::filesystem::path table, std::string_view ending) {
  if (table.extension() == ".csv") table.replace_extension();
  return table += ending;
}

std::filesystem::path StatisticsBeside(const std::filesystem::path& table) { return FileBeside(table, ".stats.csv"); }

Sweeper::Sweeper(std::string name, std::string text, SweepPlan plan)
    : name_(std::move(name)), text_(std::move(text)), plan_(std::move(plan)) {}

Sweeper::Outcome Sweeper::Fly(const Options& options, StopSignal& stop) const {
  const LawAxis laws(Section::FromText(text_, name_), plan_);
  Sweep sweep{name_, text_, plan_, laws, options.metric_file};
  if (!options.metric_file.path.empty()) sweep.own = std::make_shared<std::optional<PythonMetrics>>();
  const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  WorkerPool pool(options.jobs > 0 ? options.jobs : cores, WorkOf(sweep));
  Outcome outcome;
  try {
    const bool strict = !options.force && !IsBegun(sweep, options.out);
    const Looked first = FirstValid(sweep, strict, pool, stop);
    const SweepLaws run_laws = LookAtLaws(sweep, pool, stop);
    outcome.laws = run_laws.AllNames();
    outcome.laws.insert(outcome.laws.end(), laws.laws().begin(), laws.laws().end());
    std::vector<std::string> metrics = SweepMetricNames(outcome.laws);
    outcome.own = ListMetrics(sweep, ColumnsOf(plan_, metrics), pool, stop);
    for (const PythonMetric& metric : outcome.own) metrics.insert(metrics.end() - kWallClockColumns, metric.name);
    if (!options.metric.empty()) CheckMetric(options.metric, metrics);
    if (strict) CheckTrials(sweep, pool, stop);
    if (strict) CheckSeeds(sweep, first, pool, stop);
    SweepFile table(options.out, ColumnsOf(plan_, metrics), PlanText(sweep, first.resolved), options.force);
    if (!options.quiet)
      for (const std::string& note : laws.Notes()) std::cerr << "sweep: " << note << "\n";
    try {
      ExecuteMissing(plan_, metrics, pool, table, options.quiet, stop, outcome);
      table.Sort();
      outcome.lines = Conclude(plan_, run_laws, metrics, table, options.out);
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
