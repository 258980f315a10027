// `orchestrator runs [FOLDER]`: lists runs, removes them, keeps notes about them.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "orchestrator/recording/run_list.h"
#include "orchestrator/report/json.h"
#include "orchestrator/verbs/size_text.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

struct RunsArgs {
  std::string folder = "runs";
  std::vector<std::string> removed;
  std::optional<std::string> note;
  bool json = false;
};

std::string TimeText(std::chrono::system_clock::time_point time) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::localtime(std::chrono::system_clock::to_time_t(time)));
}

/// How it ended: its exit code, or that it has not.
std::string ExitText(const ListedRun& run) {
  if (run.exit) return std::to_string(*run.exit);
  return run.is_alive ? "flies" : "?";
}

Json ToJson(const ListedRun& run) {
  return {{"folder", run.folder},
          {"name", run.name},
          {"written", TimeText(run.written)},
          {"sim_s", run.sim_s ? Json(*run.sim_s) : Json(nullptr)},
          {"bytes", run.bytes},
          {"exit", run.exit ? Json(*run.exit) : Json(nullptr)},
          {"alive", run.is_alive},
          {"note", run.note}};
}

int List(const RunsArgs& args) {
  const std::vector<ListedRun> runs = ListRuns(args.folder);
  if (args.json) {
    Json table = Json::array();
    for (const ListedRun& run : runs) table.push_back(ToJson(run));
    std::cout << JsonText(table);
    return kExitDone;
  }
  if (runs.empty()) {
    std::cout << "no run in " << args.folder << "\n";
    return kExitDone;
  }
  const auto print = [](const std::string& written, const std::string& name, const std::string& flown,
                        const std::string& size, const std::string& exit, const std::string& folder) {
    std::cout << fmt::format("{:<19}  {:<16} {:>9} {:>8} {:>5}  {}\n", written, name, flown, size, exit, folder);
  };
  print("written", "name", "flown", "size", "exit", "folder");
  for (const ListedRun& run : runs)
    print(TimeText(run.written), run.name, run.sim_s ? fmt::format("{:g} s", *run.sim_s) : "?", SizeText(run.bytes),
          ExitText(run), run.folder + (run.note.empty() ? "" : "  # " + run.note));
  return kExitDone;
}

int Runs(const RunsArgs& args) {
  if (args.note) {
    NoteRun(args.folder, *args.note);
    return kExitDone;
  }
  for (const std::string& run : args.removed) RemoveRun(run);
  return args.removed.empty() ? List(args) : kExitDone;
}

}  // namespace

std::function<int()> SetUpRuns(CLI::App& command) {
  auto args = std::make_shared<RunsArgs>();
  command.add_option("folder", args->folder, "where the runs are; with --note, the run (default: runs)")
      ->type_name("DIR");
  auto* removed =
      command.add_option("--remove", args->removed, "remove these runs, and no other files")->type_name("RUN");
  auto* note = command.add_option("--note", args->note, "keep this note about a run; '' removes it")->type_name("TEXT");
  auto* json = command.add_flag("--json", args->json, "print the list as JSON");
  note->excludes(removed)->excludes(json);
  json->excludes(removed);
  return [args] { return Runs(*args); };
}

}  // namespace mascot
