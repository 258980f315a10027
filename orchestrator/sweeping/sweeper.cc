#include "orchestrator/sweeping/sweeper.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "base/utf8.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/sweeping/sweep_checks.h"
#include "orchestrator/sweeping/table/conclusion.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "orchestrator/sweeping/table/outcomes.h"
#include "orchestrator/sweeping/table/table.h"
#include "system/build.h"
#include "system/console.h"
#include "system/control_groups.h"
#include "system/worker_pool.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

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
  cells.push_back(Plain(done.failure));
  std::map<std::string, std::string> measured;
  if (done.failure.empty()) ReadJson<nlohmann::json>(done.answer).get_to(measured);
  for (const std::string& metric : metrics) cells.push_back(measured[metric]);
  return cells;
}

/// Executes every run of a share that is missing in the table. Updates `outcome` after each run, so that it is right
/// even if a signal ends this.
void ExecuteMissing(const SweepPlan& plan, const Sweeper::Options& options, const std::vector<std::string>& metrics,
                    WorkerPool& pool, SweepFile& table, StopSignal& stop, Sweeper::Outcome& outcome) {
  const Shard shard = options.shard.value_or(Shard{});
  Progress progress(shard.CountOf(plan.size()), table.rows(), options.quiet);
  std::size_t next = 0;
  const auto skip_done = [&] {
    while (next < plan.size() && (!shard.Has(next) || table.Has(next))) ++next;
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
    if (options.watch) options.watch(table.rows());
    ThrowIfInterrupted(stop);
  }
}

std::vector<std::string> LinesOf(const PythonNote& python) {
  if (!python.used.empty()) return {"Python: " + python.used};
  if (!python.warning.empty()) return {"warning: " + python.warning};
  return {};
}

/// What was begun at `out`; nothing if there is no such sweep.
std::optional<SweepIdentity> BegunAt(const std::string& out) { return SweepIdentity::FromText(PlanBeside(out)); }

/// Whether a table of this sweep was begun: it is then gone on with, also if --force has begun it.
bool IsBegun(const std::optional<SweepIdentity>& begun, const std::string& text, const SweepPlan& plan,
             const std::string& search) {
  if (!begun || begun->experiment != text || begun->search != search) return false;
  const SweepPlan theirs(begun->words);
  return search.empty() ? theirs.Text() == plan.Text() : plan.BeginsWith(theirs);
}

/// The numbers of a column, by run; nothing where there is none.
std::vector<std::optional<double>> NumbersOf(const std::string& column, const SweepFile::Cells& columns,
                                             const SweepFile& table) {
  const auto place = static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
  std::vector<std::optional<double>> numbers;
  table.ForEachRow([&](const SweepFile::Cells& cells) { numbers.push_back(NumberInCell(cells.at(place))); });
  return numbers;
}

/// Throws ConfigError if a search is for a metric that the user's file, which there is, does not have.
void CheckOwn(const std::string& metric, const std::vector<PythonMetric>& own) {
  if (own.empty() || metric.empty() || std::ranges::find(own, metric, &PythonMetric::name) != own.end()) return;
  std::string names;
  for (const PythonMetric& known : own) names += (names.empty() ? "" : ", ") + known.name;
  throw ConfigError({fmt::format("--metric: expected one of the metrics of the file ({}), got '{}'", names, metric)});
}

/// Throws ConfigError if the table is one of this sweep by another build: its rows may differ.
void CheckBuild(const std::optional<SweepIdentity>& begun, const SweepIdentity& ours, const std::string& out) {
  if (!begun || begun->build == ours.build) return;
  SweepIdentity same = *begun;
  same.build = ours.build;
  if (same.Text() == ours.Text())
    throw ConfigError({fmt::format("--out {}: expected a table of this build, {}, got one of {} (--force begins anew)",
                                   out, ours.build, begun->build)});
}

}  // namespace

Sweeper::Sweeper(std::string name, std::string text, SweepPlan plan)
    : name_(std::move(name)), text_(std::move(text)), plan_(std::move(plan)) {}

Sweeper::Outcome Sweeper::Fly(const Options& options, StopSignal& stop) const { return Do(options, true, stop); }

Sweeper::Outcome Sweeper::Check(const Options& options, StopSignal& stop) const { return Do(options, false, stop); }

Sweeper::Outcome Sweeper::Do(const Options& options, bool fly, StopSignal& stop) const {
  const LawAxis laws(Section::FromText(text_, name_), plan_);
  Sweep sweep{name_, text_, plan_, laws, options.metric_file};
  if (!options.metric_file.path.empty()) sweep.own = std::make_shared<std::optional<PythonMetrics>>();
  WorkerPool pool(options.jobs > 0 ? options.jobs : UsableProcessors(), WorkOf(sweep));
  SweepChecks checks(sweep, pool, stop);
  Outcome outcome;
  try {
    const auto begun = BegunAt(options.out);
    const bool is_search = !options.search.empty();
    const bool strict = !options.force && !IsBegun(begun, text_, plan_, options.search);
    if (strict && plan_.IsOfTable() && !is_search) checks.CheckRows();
    const CheckedRun first = checks.FirstValid(strict && !is_search);
    SweepIdentity& identity = outcome.identity;
    identity = {.build = BuildText(),
                .experiment = text_,
                .first_run = first.resolved,
                .metric_file = options.metric_file.text,
                .words = plan_.words(),
                .own = {},
                .law_names = {},
                .laws = checks.Laws(),
                .search = options.search};
    std::set<std::string> names = SweepLaws(plan_, identity.laws).AllNames();
    names.insert(laws.laws().begin(), laws.laws().end());
    identity.law_names.assign(names.begin(), names.end());
    identity.own = checks.Metrics(SweepColumns(plan_, SweepMetricNames(identity.law_names)));
    const std::vector<std::string> metrics = identity.Metrics();
    if (is_search) CheckOwn(options.metric, identity.own);
    outcome.column = options.metric.empty() && !identity.own.empty() ? identity.own.front().name : options.metric;
    if (!outcome.column.empty()) CheckColumn(is_search ? "--metric" : "--plot", outcome.column, metrics);
    if (strict && !plan_.IsOfTable()) checks.CheckTrials();
    if (strict) checks.CheckSeeds(first);
    if (!fly) return outcome;
    if (!options.force) CheckBuild(begun, identity, options.out);
    const SweepFile::Cells columns = SweepColumns(plan_, metrics);
    SweepFile table(
        options.out, columns, identity.Text(), options.force,
        [&](const std::string& theirs) { return identity.DifferenceFrom(theirs); }, &plan_);
    const PythonNote python = options.metric_file.path.empty() ? first.python : NoteOf(FindVirtualEnvironment());
    if (!options.quiet)
      for (const std::vector<std::string>& notes : {plan_.notes(), laws.Notes(), LinesOf(python)})
        for (const std::string& note : notes) std::cerr << "sweep: " << note << "\n";
    try {
      ExecuteMissing(plan_, options, metrics, pool, table, stop, outcome);
      table.Sort();
      if (!options.shard) outcome.lines = Conclude(plan_, identity, table, options.out);
      if (is_search) outcome.values = NumbersOf(outcome.column, columns, table);
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
