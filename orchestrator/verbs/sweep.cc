// `orchestrator sweep CONFIG`: runs one experiment many times, over values of its keys and seeds. Each run takes place
// in one process, with one process per core. Writes a table with a row for each run, and a plot of it.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "experiment/toml/input.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/sweeping/cluster/job_array.h"
#include "orchestrator/sweeping/cluster/shard.h"
#include "orchestrator/sweeping/plan/plan_table.h"
#include "orchestrator/sweeping/sweeper.h"
#include "orchestrator/sweeping/table/table.h"
#include "orchestrator/verbs/sweep_merge.h"
#include "orchestrator/verbs/sweep_picture.h"
#include "orchestrator/verbs/verb.h"
#include "system/children.h"
#include "system/interruptions.h"
#include "system/script.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct SweepArgs {
  std::string config;
  SweepPlan::Words words;
  std::optional<std::string> plan_file;  ///< a table of runs
  int jobs = 0;
  std::string out = "sweep.csv";
  std::string metric_file;
  SweepPicture picture;
  std::string shard;  ///< empty: that of this task of a job array, or all
  bool force = false, quiet = false;
  bool slurm = false, submit = false;
  std::optional<std::size_t> tasks;
  std::vector<std::string> slurm_options;
};

/// Throws ConfigError if the table has the name of the picture, which is written beside it.
void CheckOut(const std::string& out) {
  const fs::path ending = fs::path(out).extension();
  if (ending == ".png" || ending == ".pdf" || ending == ".svg")
    throw ConfigError({"--out: expected the table's file, such as sweep.csv, got '" + out + "', the picture's"});
}

/// The words that type this sweep again, without what concerns a share, the terminal or the picture.
std::vector<std::string> CommandOf(const SweepArgs& args) {
  std::vector<std::string> words{(ProgramFolder() / "orchestrator").string(), "sweep", AsWord(args.config)};
  for (const std::string& word : args.words.sets) words.insert(words.end(), {"--set", word});
  for (const std::string& word : args.words.randoms) words.insert(words.end(), {"--random", word});
  if (!args.words.randoms.empty()) words.insert(words.end(), {"--samples", std::to_string(args.words.samples)});
  if (!args.words.seeds.empty()) words.insert(words.end(), {"--seeds", args.words.seeds});
  if (args.words.zip) words.emplace_back("--zip");
  if (args.plan_file) words.insert(words.end(), {"--plan", AsWord(*args.plan_file)});
  if (!args.metric_file.empty()) words.insert(words.end(), {"--metric", AsWord(args.metric_file)});
  words.insert(words.end(), {"--out", AsWord(args.out)});
  return words;
}

/// How many tasks a job array has unless told: of a hundred runs each, and no more than clusters usually take.
std::size_t UsualTasks(std::size_t runs) {
  constexpr std::size_t kRunsOfATask = 100, kMaxTasks = 1000;
  return std::clamp((runs + kRunsOfATask - 1) / kRunsOfATask, std::size_t{1}, kMaxTasks);
}

/// Writes the script of a job array, and submits it if asked to.
int WriteJobArray(const SweepArgs& args, std::size_t runs, StopSignal& stop) {
  const std::size_t tasks = args.tasks.value_or(UsualTasks(runs));
  if (tasks > runs)
    throw ConfigError({fmt::format("--tasks: expected at most {}, one for each run, got {}", runs, tasks)});
  const std::string script = FileBeside(args.out, ".sbatch");
  WriteWhole(script, JobArrayScript({.command = CommandOf(args),
                                     .folder = fs::current_path(),
                                     .out = args.out,
                                     .runs = runs,
                                     .tasks = tasks,
                                     .jobs = std::max(args.jobs, 1),
                                     .options = args.slurm_options}));
  if (!args.quiet) std::cout << runs << " runs in " << tasks << " tasks: " << script << "\n";
  if (!args.submit) {
    if (!args.quiet) std::cout << "submit it: sbatch " << script << "\n";
    return kExitDone;
  }
  std::cout << std::flush;  // before sbatch prints
  return RunProgram({"sbatch", AsWord(script)}, stop);
}

/// Throws ConfigError for options that exclude each other, in a way that the parser cannot say.
void CheckSlurm(const SweepArgs& args) {
  if (!args.slurm) return;
  if (!args.shard.empty())
    throw ConfigError({"--slurm: expected no --shard, because each task of the job array has its own"});
  for (const std::string& file : {args.config, args.plan_file.value_or("")})
    if (DescriptorOf(file))
      throw ConfigError({"--slurm: expected a file, which each task of the job array reads, got " + NameOfInput(file)});
  if (args.force)
    throw ConfigError({"--slurm: expected no --force, because a task that is queued again goes on with what is there"});
}

/// The runs that the options give.
SweepPlan PlanOf(const SweepArgs& args) {
  if (!args.plan_file) return SweepPlan(args.words);
  const std::string& path = *args.plan_file;
  if (DescriptorOf(path) && DescriptorOf(path) == DescriptorOf(args.config))
    throw ConfigError({"--plan: expected another input than CONFIG, got " + NameOfInput(path) + " for both"});
  return {args.words, ReadPlanTable(ReadInput(path), NameOfInput(path))};
}

/// The share of the runs to fly; nothing: all.
std::optional<Shard> ShardOf(const SweepArgs& args) {
  if (!args.shard.empty()) return ParseShard("--shard", args.shard);
  return args.slurm ? std::nullopt : ShardOfThisTask();
}

/// ", 40 of them flown now": what this command did of `runs` runs; "" for all.
std::string FlownNow(std::size_t runs, std::size_t flown) {
  if (flown == runs) return "";
  return fmt::format(", {} flown now", flown == 0 ? "none" : std::to_string(flown) + " of them");
}

/// Prints how a share ended.
void PrintShare(const SweepArgs& args, const Shard& shard, const Sweeper::Outcome& outcome, std::size_t runs,
                const std::string& table) {
  const std::size_t ours = shard.CountOf(runs);
  std::cout << fmt::format("share {}, {} of {} runs{}: {}\n", shard.Text(), ours, runs, FlownNow(ours, outcome.flown),
                           table);
  if (outcome.failed > 0) std::cout << "failed: " << outcome.failed << " of those flown now\n";
  std::cout << "when all shares are there: orchestrator sweep merge " << TablesOfShards(args.out, shard.of).string()
            << " --out " << args.out << "\n";
}

int Run(const SweepArgs& args) {
  StopSignal stop;
  std::optional<EndsAtOnce> before_the_sweep(stop);
  if (args.config.empty()) throw ConfigError({"sweep: expected CONFIG, an experiment file, or merge FILE..."});
  CheckOut(args.out);
  CheckSlurm(args);
  const std::optional<Shard> shard = ShardOf(args);
  const std::string out = shard ? TableOfShard(args.out, *shard).string() : args.out;
  const Sweeper sweeper(NameOfInput(args.config), ReadInput(args.config), PlanOf(args));
  const std::size_t runs = sweeper.plan().size();
  MetricFile metric_file{args.metric_file, ""};
  if (!args.metric_file.empty()) metric_file.text = ReadRegularFile(args.metric_file);
  const bool drawable = args.picture.IsDrawable(sweeper.plan()) && !shard;
  const Sweeper::Options options{.jobs = args.jobs,
                                 .out = out,
                                 .shard = shard,
                                 .metric = args.picture.metric.value_or(""),
                                 .metric_file = metric_file,
                                 .force = args.force,
                                 .quiet = args.quiet};
  before_the_sweep.reset();
  if (args.slurm) {
    const Sweeper::Outcome checked = sweeper.Check(options, stop);
    return checked.signal != 0 ? 128 + checked.signal : WriteJobArray(args, runs, stop);
  }
  const Sweeper::Outcome outcome = sweeper.Fly(options, stop);
  if (outcome.signal != 0) {
    if (outcome.in_table)
      std::cerr << "interrupted: " << *outcome.in_table << " of " << (shard ? shard->CountOf(runs) : runs)
                << " runs are in the table; the same command" << (args.force ? ", without --force, " : " ")
                << "goes on with the others\n";
    return 128 + outcome.signal;
  }
  const int picture = drawable ? args.picture.Draw(out, sweeper.plan(), outcome.identity, stop) : kExitDone;
  if (!args.quiet && shard) PrintShare(args, *shard, outcome, runs, out);
  if (!args.quiet && !shard) {
    std::cout << runs << " runs" << FlownNow(runs, outcome.flown) << ": " << out << "\n";
    for (const std::string& line : outcome.lines) std::cout << line << "\n";
    if (drawable && picture == kExitDone) args.picture.files.PrintNames(out);
  }
  if (outcome.flown > 0 && outcome.failed == outcome.flown) return kExitFailed;
  return picture;
}

}  // namespace

std::function<int()> SetUpSweep(CLI::App& command) {
  auto args = std::make_shared<SweepArgs>();
  command.add_option("config", args->config, "experiment file (TOML); -: standard input")->type_name("CONFIG");
  command
      .add_option("--set", args->words.sets,
                  "a key and its values: KEY=A:STEP:B, KEY=V1,V2,..., or one value; every combination is flown")
      ->type_name("KEY=VALUES")
      ->allow_extra_args(false);
  auto* random =
      command.add_option("--random", args->words.randoms, "a key and the range that its values are drawn from")
          ->type_name("KEY=MIN:MAX[:log]")
          ->allow_extra_args(false);
  auto* samples =
      command.add_option("--samples", args->words.samples, "how many times all --random keys are drawn together")
          ->check(CLI::Range(1, 10'000'000))
          ->type_name("N");
  random->needs(samples);
  samples->needs(random);
  command.add_option("--seeds", args->words.seeds, "fly each combination with each of these seeds: A..B or A,B,...")
      ->type_name("SEEDS");
  command.add_flag("--zip", args->words.zip,
                   "fly the values of the --set keys row by row, the first of each key, the second of each, ..., and "
                   "not every combination");
  command
      .add_option("--plan", args->plan_file,
                  "a table of the runs (CSV): the first line has keys, each other line their values in one run")
      ->type_name("FILE");
  command.add_option("--jobs", args->jobs, "processes that fly at the same time (default: one per core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  command.add_option("--out", args->out, "the table (default: sweep.csv)")->type_name("FILE");
  command
      .add_option("--metric", args->metric_file,
                  "a Python file: each of its functions of the arrays of a run becomes a column")
      ->type_name("FILE");
  args->picture.SetUp(command);
  command
      .add_option("--shard", args->shard,
                  "fly only the I-th of N shares of the runs, into a table of its own (default in a task of a Slurm "
                  "job array: the task's share)")
      ->type_name("I/N");
  auto* slurm =
      command.add_flag("--slurm", args->slurm, "fly nothing, but write a job array for Slurm beside the table");
  command
      .add_option("--tasks", args->tasks,
                  "with --slurm: how many tasks the job array has (default: one for 100 runs, at most 1000)")
      ->check(CLI::Range(1, 1'000'000))
      ->needs(slurm)
      ->type_name("N");
  command
      .add_option("--slurm-option", args->slurm_options,
                  "with --slurm: an option for sbatch, such as --time=12:00:00; may be given several times")
      ->needs(slurm)
      ->allow_extra_args(false)
      ->type_name("OPTION");
  command.add_flag("--submit", args->submit, "with --slurm: hand the job array to sbatch")->needs(slurm);
  command.add_flag(
      "--force", args->force,
      "begin anew if the table is that of another sweep; fly even if values are mistakes or seeds change nothing");
  command.add_flag("--quiet", args->quiet, "print errors only");
  CLI::App& merge = *command.add_subcommand("merge", "the tables of all shares as the table of the whole sweep");
  return [args, &merge, run_merge = SetUpSweepMerge(merge)] { return merge.parsed() ? run_merge() : Run(*args); };
}

}  // namespace mascot
