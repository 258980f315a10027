// `orchestrator sweep merge FILE...`: makes of the tables of all shares of a sweep the table of the whole.
#include "orchestrator/verbs/sweep_merge.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "orchestrator/sweeping/cluster/merge.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "orchestrator/verbs/sweep_picture.h"
#include "orchestrator/verbs/verb.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

struct MergeArgs {
  std::vector<std::string> files;
  std::string out;
  SweepPicture picture;
  bool force = false, quiet = false;
};

int Run(const MergeArgs& args) {
  std::vector<std::filesystem::path> tables;
  for (const std::string& word : args.files)
    for (const std::filesystem::path& table : TablesNamed(word)) tables.push_back(table);
  const std::string out = args.out.empty() ? MergedTable(tables).string() : args.out;
  const SweepIdentity identity = IdentityOf(tables.front());
  const SweepPlan plan(identity.words);
  const bool drawable = args.picture.IsDrawable(plan);
  if (args.picture.metric) CheckColumn("--plot", *args.picture.metric, identity.Metrics());
  const Merged merged = Merge(tables, out, args.force);
  StopSignal stop;
  const int picture = drawable ? args.picture.Draw(out, plan, identity, stop) : kExitDone;
  if (args.quiet) return picture;
  std::cout << merged.runs << " runs of " << tables.size() << " tables: " << out << "\n";
  for (const std::string& line : merged.lines) std::cout << line << "\n";
  if (drawable && picture == kExitDone) args.picture.files.PrintNames(out);
  return picture;
}

}  // namespace

std::function<int()> SetUpSweepMerge(CLI::App& command) {
  auto args = std::make_shared<MergeArgs>();
  command.add_option("files", args->files, "the tables of all shares, or the name of the table whose shares they are")
      ->required()
      ->type_name("FILE");
  command.add_option("--out", args->out, "the table (default: sweep.csv of sweep.1-of-3.csv, ...)")->type_name("FILE");
  args->picture.SetUp(command);
  command.add_flag("--force", args->force, "replace a table of another sweep at --out");
  command.add_flag("--quiet", args->quiet, "print errors only");
  return [args] { return Run(*args); };
}

}  // namespace mascot
