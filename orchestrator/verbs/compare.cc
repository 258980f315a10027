// `orchestrator compare RUN...`: the summaries of runs side by side, and their pictures in one.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/sweeping/table/side_by_side.h"
#include "orchestrator/verbs/verb.h"
#include "system/script.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

struct CompareArgs {
  std::vector<std::string> runs;
  std::string plot;
  bool json = false;
};

int Compare(CompareArgs args) {
  if (args.runs.size() < 2) throw ConfigError({"compare: expected at least 2 runs, got 1"});
  for (std::string& run : args.runs) run = FindRun(run);
  const SideBySide table(args.runs);
  std::cout << (args.json ? table.JsonText() : table.Text());
  if (args.plot.empty()) return kExitDone;
  StopSignal stop;
  std::vector<std::string> words;
  for (const std::string& run : args.runs) words.push_back(AsWord(run));
  words.insert(words.end(), {"--overlay", "--out=" + args.plot});
  return RunScript("plot.py", words, stop);
}

}  // namespace

std::function<int()> SetUpCompare(CLI::App& command) {
  auto args = std::make_shared<CompareArgs>();
  command.add_option("run", args->runs, "run folders")->required()->type_name("RUN");
  command.add_option("--plot", args->plot, "draw all runs into the same pictures, in this folder")->type_name("FOLDER");
  command.add_flag("--json", args->json, "print JSON and nothing else");
  return [args] { return Compare(*args); };
}

}  // namespace mascot
