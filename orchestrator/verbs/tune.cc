// `orchestrator tune CONFIG`: searches for values of keys with which a figure of the run is smallest or largest.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/toml/input.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/searching/tuner.h"
#include "orchestrator/sweeping/plan/labels.h"
#include "orchestrator/sweeping/table/table.h"
#include "orchestrator/verbs/one_of.h"
#include "orchestrator/verbs/sweep_picture.h"
#include "orchestrator/verbs/verb.h"
#include "system/console.h"
#include "system/interruptions.h"
#include "system/script.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

struct TuneArgs {
  std::string config, metric, out = "tune.csv", over_seeds = "mean";
  Tuner::Setting setting;
  PictureFiles picture;
  int jobs = 0;
  bool force = false, quiet = false;
};

/// Takes --metric apart: COLUMN, FILE.py or FILE.py:NAME.
void SetMetric(const std::string& word, Tuner::Setting& setting) {
  const auto colon = word.rfind(".py:");
  if (colon == std::string::npos && !word.ends_with(".py")) {
    setting.metric = word;
    return;
  }
  const std::string file = colon == std::string::npos ? word : word.substr(0, colon + 3);
  if (colon != std::string::npos) setting.metric = word.substr(colon + 4);
  setting.metric_file = {.path = file, .text = ReadRegularFile(file)};
}

std::string NumberText(const std::optional<double>& value) { return value ? fmt::format("{:.6g}", *value) : "none"; }

/// What the experiment file itself has: " (with the file's own values: 8.4)".
std::string ComparedWithFile(const Tuner::Outcome& outcome) {
  if (!outcome.begins_with_file) return "";
  if (*outcome.best == 0) return " (the file's own values)";
  return fmt::format(" (with the file's own values: {})", NumberText(outcome.rows.front().value));
}

int Draw(const TuneArgs& args, const Tuner& tuner, const Tuner::Outcome& outcome, StopSignal& stop) {
  const auto own = std::ranges::find(outcome.sweep.identity.own, outcome.column, &PythonMetric::name);
  const bool is_own = own != outcome.sweep.identity.own.end();
  std::vector<std::string> words{AsWord(args.out), AsWord(FileBeside(args.out, ".png")), outcome.column};
  for (const std::string& key : tuner.keys()) {
    words.push_back(key);
    words.insert(words.end(), {"--label", key + "=" + LabelOfKey(key, outcome.sweep.identity.law_names)});
  }
  for (const std::string& key : tuner.log_keys()) words.insert(words.end(), {"--log", key});
  words.insert(words.end(),
               {"--label", outcome.column + "=" + (is_own ? LabelOfMetric(*own) : LabelOfColumn(outcome.column))});
  words.insert(words.end(),
               {"--over-seeds", args.over_seeds, "--format", args.picture.format, "--size", args.picture.size});
  if (args.setting.maximize) words.emplace_back("--maximize");
  return RunScript("plot_tuning.py", words, stop);
}

void PrintBest(const TuneArgs& args, const Tuner& tuner, const Tuner::Outcome& outcome) {
  const Tuner::Flown& best = outcome.rows[*outcome.best];
  const std::vector<std::string> keys = tuner.keys();
  std::cout << fmt::format("best of {} candidates: {} = {}{}\n", outcome.rows.size(), outcome.column,
                           NumberText(best.value), ComparedWithFile(outcome));
  for (std::size_t k = 0; k < keys.size(); ++k) std::cout << fmt::format("  {} = {}\n", keys[k], best.values[k]);
  std::cout << fmt::format("fly it: orchestrator up {} {}\n", args.config,
                           fmt::join(tuner.OptionsOf(best.values), " "));
}

int Run(TuneArgs args) {
  StopSignal stop;
  std::optional<EndsAtOnce> before_the_search(stop);
  SetMetric(args.metric, args.setting);
  args.setting.over_seeds = kOverSeeds.Value(args.over_seeds);
  const Tuner tuner(NameOfInput(args.config), ReadInput(args.config), args.setting);
  before_the_search.reset();
  Console console(args.quiet);
  const auto watch = [&](std::size_t rows, std::size_t of, std::optional<double> best) {
    console.Progress(static_cast<double>(rows) / static_cast<double>(of),
                     fmt::format("{} of {} runs{}", rows, of, best ? " | best so far " + NumberText(best) : ""));
  };
  const Tuner::Outcome outcome =
      tuner.Search({.jobs = args.jobs, .out = args.out, .force = args.force, .watch = watch}, stop);
  console.EndProgress();
  if (outcome.signal != 0) {
    std::cerr << "interrupted; the same command" << (args.force ? ", without --force, " : " ")
              << "goes on with what is in " << args.out << "\n";
    return 128 + outcome.signal;
  }
  if (!outcome.best) {
    for (const std::string& line : outcome.sweep.lines) std::cerr << line << "\n";
    std::cerr << fmt::format("error: tune: expected a value of {} for some candidate, got none of {}\n", outcome.column,
                             outcome.rows.size());
    return kExitFailed;
  }
  const bool drawable = !args.picture.none && outcome.rows.size() > 1;
  const int picture = drawable ? Draw(args, tuner, outcome, stop) : kExitDone;
  if (args.quiet) return picture;
  PrintBest(args, tuner, outcome);
  std::cout << "table: " << args.out << "\n";
  for (const std::string& line : outcome.sweep.lines) std::cout << line << "\n";
  if (drawable && picture == kExitDone) args.picture.PrintNames(args.out);
  return picture;
}

}  // namespace

std::function<int()> SetUpTune(CLI::App& command) {
  auto args = std::make_shared<TuneArgs>();
  Tuner::Setting& setting = args->setting;
  command.add_option("config", args->config, "experiment file (TOML); -: standard input")
      ->required()
      ->type_name("CONFIG");
  command
      .add_option("--metric", args->metric,
                  "what shall be smallest: a column of the table of a sweep, such as consensus.settling_time_s, or a "
                  "function of a Python file")
      ->required()
      ->type_name("COLUMN|FILE.py[:NAME]");
  command.add_option("--random", setting.randoms, "a key, and the range from which its values are chosen")
      ->type_name("KEY=MIN:MAX[:log]")
      ->allow_extra_args(false);
  command.add_option("--set", setting.sets, "a key, and the values of which one is chosen; or one value for all runs")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  command.add_option("--budget", setting.budget, "how many candidates are tried")
      ->required()
      ->check(CLI::Range(1, 100'000))
      ->type_name("N");
  auto* seeds =
      command.add_option("--seeds", setting.seeds, "fly each candidate with each of these seeds: A..B or A,B,...")
          ->type_name("SEEDS");
  command.add_option("--over-seeds", args->over_seeds, "what counts of the seeds: mean, median or worst (mean)")
      ->check(OneOf({kOverSeeds.names().begin(), kOverSeeds.names().end()}))
      ->type_name("HOW")
      ->needs(seeds);
  command.add_flag("--maximize", setting.maximize, "the metric shall be largest");
  command
      .add_option("--batch", setting.batch,
                  "how many candidates are proposed at once, before the metric of any of them is known (default: 8)")
      ->check(CLI::Range(1, 10'000))
      ->type_name("N");
  command.add_option("--optimizer-seed", setting.seed, "another seed of the optimiser proposes others (default: 0)")
      ->check(CLI::Range(0, 2'147'483'647))
      ->type_name("N");
  command.add_option("--jobs", args->jobs, "processes that fly at the same time (default: one per core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command.add_option("--out", args->out, "the table (default: tune.csv)")->type_name("FILE");
  args->picture.SetUp(command);
  command.add_flag("--force", args->force, "begin anew if the table is that of another search or sweep");
  command.add_flag("--quiet", args->quiet, "print errors only");
  return [args] { return Run(*args); };
}

}  // namespace mascot
