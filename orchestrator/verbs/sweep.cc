// `orchestrator sweep CONFIG`: runs one experiment many times, over values of its keys and seeds. Each run takes place
// in one process, with one process per core. Writes a table with a row for each run, and a plot of it.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "bus/stop_signal.h"
#include "orchestrator/processes/script.h"
#include "orchestrator/sweeping/labels.h"
#include "orchestrator/sweeping/metrics.h"
#include "orchestrator/sweeping/outcomes.h"
#include "orchestrator/sweeping/sweeper.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct SweepArgs {
  std::string config;
  SweepPlan::Words words;
  int jobs = 0;
  std::string out = "sweep.csv";
  std::optional<std::string> metric;  ///< the column to plot; absent: the first of metric_file, or kUsualMetric
  std::string metric_file;
  std::string format = "png", size = "screen";  ///< of the picture; scripts/plot_sweep.py knows what they may be
  bool force = false, no_plot = false, quiet = false;
};

/// Throws ConfigError if the table has the name of the picture, which is written beside it.
void CheckOut(const std::string& out) {
  const fs::path ending = fs::path(out).extension();
  if (ending == ".png" || ending == ".pdf" || ending == ".svg")
    throw ConfigError({"--out: expected the table's file, such as sweep.csv, got '" + out + "', the picture's"});
}

/// Whether the sweep can be plotted: over at most two keys, or over seeds alone. Throws ConfigError if --plot asks for
/// a plot that is not possible.
bool IsDrawable(const SweepArgs& args, const SweepPlan& plan) {
  constexpr std::size_t kMostKeys = 2;
  if (args.metric && plan.size() < 2) throw ConfigError({"--plot: expected at least 2 runs to draw, got 1"});
  if (args.no_plot || plan.size() < 2) return false;
  if (plan.varied().size() > kMostKeys && args.metric)
    throw ConfigError({"--plot: expected at most 2 keys of several values to draw over, got " +
                       std::to_string(plan.varied().size())});
  return plan.varied().size() <= kMostKeys;
}

int Picture(const SweepArgs& args, const SweepPlan& plan, const Sweeper::Outcome& outcome, StopSignal& stop) {
  const std::string column = args.metric.value_or(outcome.own.empty() ? kUsualMetric : outcome.own.front().name);
  const auto own = std::ranges::find(outcome.own, column, &PythonMetric::name);
  std::vector<std::string> words{args.out, StatisticsBeside(args.out), FileBeside(args.out, ".png"), column};
  words.insert(words.end(), plan.varied().begin(), plan.varied().end());
  words.insert(words.end(),
               {"--label", column + "=" + (own != outcome.own.end() ? LabelOfMetric(*own) : LabelOfColumn(column))});
  for (const std::string& key : plan.varied())
    words.insert(words.end(), {"--label", key + "=" + LabelOfKey(key, outcome.laws)});
  if (IsTimeOfEvent(column)) words.emplace_back("--time");
  words.insert(words.end(), {"--format", args.format, "--size", args.size});
  return RunScript("plot_sweep.py", words, stop);
}

int Run(const SweepArgs& args) {
  StopSignal stop;
  CheckOut(args.out);
  const Sweeper sweeper(args.config, ReadRegularFile(args.config), SweepPlan(args.words));
  const std::size_t runs = sweeper.plan().size();
  Sweeper::MetricFile metric_file{args.metric_file, ""};
  if (!args.metric_file.empty()) metric_file.text = ReadRegularFile(args.metric_file);
  const bool drawable = IsDrawable(args, sweeper.plan());
  const Sweeper::Outcome outcome = sweeper.Fly({.jobs = args.jobs,
                                                .out = args.out,
                                                .metric = args.metric.value_or(""),
                                                .metric_file = metric_file,
                                                .force = args.force,
                                                .quiet = args.quiet},
                                               stop);
  if (outcome.signal != 0) {
    if (outcome.in_table)
      std::cerr << "interrupted: " << *outcome.in_table << " of " << runs << " runs are in the table; the same command"
                << (args.force ? ", without --force, " : " ") << "goes on with the others\n";
    return 128 + outcome.signal;
  }
  const int picture = drawable ? Picture(args, sweeper.plan(), outcome, stop) : 0;
  if (!args.quiet)
    std::cout << runs << " runs, " << outcome.failed << " of those flown now failed: " << args.out << "\n";
  if (!args.quiet)
    for (const std::string& line : outcome.lines) std::cout << line << "\n";
  if (!args.quiet && drawable && picture == kExitDone) {
    std::istringstream formats(args.format);
    for (std::string format; std::getline(formats, format, ',');)
      std::cout << "picture: " << FileBeside(args.out, "." + format).string() << "\n";
  }
  if (outcome.flown > 0 && outcome.failed == outcome.flown) return 1;
  return picture;
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
  command
      .add_option("--metric", args->metric_file,
                  "a Python file: each of its functions of the arrays of a run is a column")
      ->type_name("FILE");
  command.add_option("--plot", args->metric, "the column that the picture shows")->type_name("COLUMN");
  command.add_option("--format", args->format, "of the picture: png, pdf, svg; several with commas between (png)")
      ->type_name("LIST");
  command.add_option("--size", args->size, "of the picture: screen, column or page, as of orchestrator plot (screen)")
      ->check(CLI::IsMember({"screen", "column", "page"}))
      ->type_name("SIZE");
  command.add_flag("--no-plot", args->no_plot, "no picture");
  command.add_flag(
      "--force", args->force,
      "begin anew where --out holds another sweep; fly also where values are mistakes or seeds change nothing");
  command.add_flag("--quiet", args->quiet, "print errors only");
  return [args] { return Run(*args); };
}

}  // namespace mascot
