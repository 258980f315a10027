// `orchestrator sweep CONFIG`: one experiment many times, over values of its keys and seeds, in one process each run,
// all cores at work; a table with a row for each run, and a picture of it.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "agent/laws.h"
#include "bus/stop_signal.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/processes/worker_pool.h"
#include "orchestrator/report/summary.h"
#include "orchestrator/sweeping/metrics.h"
#include "orchestrator/sweeping/plan.h"
#include "orchestrator/sweeping/table.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/verbs/plot.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;
namespace fs = std::filesystem;

constexpr const char* kUsualMetric = "consensus.final_disagreement_m";

struct SweepArgs {
  std::string config;
  SweepPlan::Words words;
  int jobs = 0;
  std::string out = "sweep.csv";
  std::optional<std::string> metric;  ///< that the picture shows; none given: kUsualMetric
  bool force = false, no_plot = false, quiet = false;
};

/// What every run of a sweep is made from: the experiment's text as it was at the start, whoever edits it meanwhile.
/// (Files that it names are read for each run.)
struct Sweep {
  std::string name;  ///< of the file, as typed
  std::string text;
  SweepPlan plan;

  Experiment Load(std::size_t run) const {
    const Section document = Section::FromText(text, name, plan[run].overrides);
    Experiment experiment = LoadExperiment(document, fs::path(name).stem().string());
    if (experiment.run.mode == Mode::kRealtime)
      throw ConfigError({"sweep: expected run.mode = \"lockstep\", got \"realtime\""});
    return experiment;
  }
};

/// One run, start to end; its summary. Throws std::runtime_error if it fails.
std::string Fly(const Sweep& sweep, std::size_t run) {
  Experiment experiment = sweep.Load(run);
  const Prediction prediction = Predict(experiment);
  RunMeter meter(experiment);
  const EngineResult result = RunInProcess(
      experiment, [&](std::int64_t tick, const DecodedRow& row) { meter.Add(tick, row); },
      [](std::int64_t) { return true; });
  if (!result.failure.empty()) throw std::runtime_error(result.failure);
  const RunFacts facts{.engine = "inprocess"};
  return SummaryJson(experiment, prediction, meter, result, facts);
}

/// Tasks of the pool: runs, then the same runs again, to be read and checked only; of those the resolved experiment.
WorkerPool::Work WorkOf(const Sweep& sweep) {
  return [&sweep](std::size_t task) -> std::string {
    if (task >= sweep.plan.size()) return sweep.Load(task - sweep.plan.size()).document.Resolved();
    nlohmann::json cells = SweepMetrics(Fly(sweep, task));
    return cells.dump();
  };
}

struct Interrupted {
  int signal;
};

/// Throws Interrupted if a signal has come.
void ThrowIfInterrupted(StopSignal& stop) {
  if (const int signal = stop.Within(std::chrono::nanoseconds::zero()); signal != 0) throw Interrupted{signal};
}

/// The first run that is a valid experiment, resolved. Refuses a sweep that has none, with the mistakes of the first.
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
    if (there > 0)
      console_.Line("going on: " + std::to_string(there) + " of " + std::to_string(runs) + " runs are in the table");
  }
  ~Progress() { console_.EndProgress(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Show(std::size_t done, std::size_t failed) {
    const double elapsed_s = std::chrono::duration<double>(WallClock::now() - start_).count();
    const double left_s =
        done > 0 ? elapsed_s / static_cast<double>(done) * static_cast<double>(runs_ - there_ - done) : 0;
    char text[120];
    std::snprintf(text, sizeof text, "%zu of %zu runs | %zu failed | %s%.0f s left", there_ + done, runs_, failed,
                  done > 0 ? "about " : "", left_s);
    console_.Progress(static_cast<double>(there_ + done) / static_cast<double>(runs_), text);
  }

 private:
  std::size_t runs_, there_;
  Console console_;
  WallClock::time_point start_ = WallClock::now();
};

/// Cells of a run behind its number: what was set, its error, what was measured.
SweepFile::Cells RowOf(const SweepPoint& point, const WorkerPool::Done& done) {
  SweepFile::Cells cells;
  for (const Override& override : point.overrides) cells.push_back(override.value);
  cells.push_back(done.failure);
  const auto measured = done.failure.empty() ? nlohmann::json::parse(done.answer).get<SweepFile::Cells>()
                                             : SweepFile::Cells(SweepMetricNames().size());
  cells.insert(cells.end(), measured.begin(), measured.end());
  return cells;
}

struct Outcome {
  std::size_t flown = 0, failed = 0;
};

/// Every run that the table lacks.
Outcome WorkOff(const SweepPlan& plan, WorkerPool& pool, SweepFile& table, bool quiet, StopSignal& stop) {
  Progress progress(plan.size(), table.rows(), quiet);
  Outcome outcome;
  std::size_t next = 0;
  const auto skip_done = [&] {
    while (next < plan.size() && table.Has(next)) ++next;
    return next < plan.size();
  };
  while (skip_done() || pool.IsBusy()) {
    while (skip_done() && pool.HasIdle()) pool.Start(next++);
    if (const auto done = pool.Wait(std::chrono::milliseconds(100))) {
      table.Add(done->task, RowOf(plan[done->task], *done));
      ++outcome.flown;
      outcome.failed += !done->failure.empty();
    }
    progress.Show(outcome.flown, outcome.failed);
    ThrowIfInterrupted(stop);
  }
  return outcome;
}

SweepFile::Cells ColumnsOf(const SweepPlan& plan) {
  SweepFile::Cells columns{"run"};
  columns.insert(columns.end(), plan.keys().begin(), plan.keys().end());
  columns.push_back(kErrorColumn);
  const auto names = SweepMetricNames();
  columns.insert(columns.end(), names.begin(), names.end());
  return columns;
}

/// By which a table is known: the experiment as it was typed, a resolved one with the files that it names, what each
/// run sets.
std::string PlanText(const Sweep& sweep, const std::string& resolved) {
  std::string text;
  for (std::size_t run = 0; run < sweep.plan.size(); ++run) {
    for (const Override& override : sweep.plan[run].overrides) text += override.key + "=" + override.value + " ";
    text += "\n";
  }
  return sweep.text + "\n# its first valid run\n" + resolved + "\n# runs of the sweep\n" + text;
}

void CheckMetric(const std::string& metric) {
  const std::vector<std::string> names = SweepMetricNames();
  if (std::ranges::find(names, metric) != names.end()) return;
  const std::vector<std::string_view> views(names.begin(), names.end());
  const auto nearest = DidYouMean(metric, views);
  throw ConfigError({"--plot: expected a column of the table, such as " + std::string(kUsualMetric) + ", got '" +
                     metric + "'" + (nearest ? " (did you mean \"" + *nearest + "\"?)" : "")});
}

/// The picture goes beside the table, under the same name.
void CheckOut(const std::string& out) {
  if (fs::path(out).extension() == ".png")
    throw ConfigError({"--out: expected the table's file, such as sweep.csv, got '" + out + "', the picture's"});
}

/// Two keys can be drawn, or seeds alone.
bool IsDrawable(const SweepArgs& args, const SweepPlan& plan) {
  constexpr std::size_t kMostKeys = 2;
  if (args.metric && plan.size() < 2) throw ConfigError({"--plot: expected at least 2 runs to draw, got 1"});
  if (args.no_plot || plan.size() < 2) return false;
  if (plan.varied().size() > kMostKeys && args.metric)
    throw ConfigError({"--plot: expected at most 2 keys of several values to draw over, got " +
                       std::to_string(plan.varied().size())});
  return plan.varied().size() <= kMostKeys;
}

int Picture(const SweepArgs& args, const SweepPlan& plan, StopSignal& stop) {
  std::vector<std::string> words{args.out, fs::path(args.out).replace_extension(".png"),
                                 args.metric.value_or(kUsualMetric)};
  words.insert(words.end(), plan.varied().begin(), plan.varied().end());
  return RunScript("plot_sweep.py", words, stop);
}

int FlyAll(const SweepArgs& args, const Sweep& sweep, bool drawable, StopSignal& stop) {
  WorkerPool pool(args.jobs > 0 ? args.jobs : static_cast<int>(std::max(1u, std::thread::hardware_concurrency())),
                  WorkOf(sweep));
  const std::string plan = PlanText(sweep, FirstValid(sweep, pool, stop));
  SweepFile table(args.out, ColumnsOf(sweep.plan), plan, args.force);
  Outcome outcome;
  try {
    outcome = WorkOff(sweep.plan, pool, table, args.quiet, stop);
  } catch (const Interrupted&) {
    std::cerr << "interrupted: " << table.rows() << " of " << sweep.plan.size()
              << " runs are in the table; the same command" << (args.force ? ", without --force, " : " ")
              << "goes on with the others\n";
    throw;
  }
  table.Sort();
  const int picture = drawable ? Picture(args, sweep.plan, stop) : 0;
  if (!args.quiet)
    std::cout << sweep.plan.size() << " runs, " << outcome.failed << " of those flown now failed: " << args.out << "\n";
  if (outcome.flown > 0 && outcome.failed == outcome.flown) return 1;
  return picture;
}

int Run(const SweepArgs& args) {
  StopSignal stop;
  if (args.metric) CheckMetric(*args.metric);
  CheckOut(args.out);
  const Sweep sweep{args.config, ReadRegularFile(args.config), SweepPlan(args.words)};
  const bool drawable = IsDrawable(args, sweep.plan);
  try {
    return FlyAll(args, sweep, drawable, stop);
  } catch (const Interrupted& interrupted) {
    return 128 + interrupted.signal;
  }
}

}  // namespace

std::function<int()> SetUpSweep(CLI::App& command) {
  auto args = std::make_shared<SweepArgs>();
  command.add_option("config", args->config, "experiment file (TOML)")->required()->type_name("CONFIG");
  command
      .add_option("--set", args->words.sets,
                  "a key and its values: KEY=A:STEP:B, KEY=V1,V2,..., or one value; every combination is run")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  auto* random =
      command.add_option("--random", args->words.randoms, "a key and the range that its values are drawn from")
          ->type_name("KEY=MIN:MAX[:log]")
          ->allow_extra_args(false);
  auto* samples = command.add_option("--samples", args->words.samples, "draws of all --random keys")
                      ->check(CLI::Range(1, 10'000'000))
                      ->type_name("N");
  random->needs(samples);
  samples->needs(random);
  command.add_option("--seeds", args->words.seeds, "each combination with each of these: A..B or A,B,...")
      ->type_name("SEEDS");
  command.add_option("--jobs", args->jobs, "processes at work (default: one per core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command.add_option("--out", args->out, "the table (default: sweep.csv)")->type_name("FILE");
  command.add_option("--plot", args->metric, "the column that the picture shows")->type_name("COLUMN");
  command.add_flag("--no-plot", args->no_plot, "no picture");
  command.add_flag("--force", args->force, "begin anew where --out holds another sweep");
  command.add_flag("--quiet", args->quiet, "print errors only");
  return [args] { return Run(*args); };
}

}  // namespace mascot
