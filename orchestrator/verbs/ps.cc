#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "experiment/toml/section.h"
#include "orchestrator/control/running_runs.h"
#include "orchestrator/verbs/verb.h"
#include "system/standard_streams.h"

namespace mascot {
namespace {

std::string StateOf(const RunningRun& run) {
  if (run.tick < 0) return "starts";
  if (run.paused) return "paused";
  return run.pace > 0 ? fmt::format("runs at {}", ShortestFloat(run.pace)) : "runs";
}

std::string LineOf(const RunningRun& run) {
  switch (run.voice) {
    case RunningRun::Voice::kOfOthers:
      return fmt::format("{:<8} run of user {}", run.process, run.user);
    case RunningRun::Voice::kStopped:
      return fmt::format("{:<8} stopped; `kill -CONT {}` lets it go on", run.process, run.process);
    case RunningRun::Voice::kSilent:
      return fmt::format("{:<8} does not answer", run.process);
    case RunningRun::Voice::kAnswers:
      break;
  }
  return fmt::format("{:<8} {:<20} {:>6} {:>6} {:>18}  {:<12} {}{}", run.process, run.name,
                     run.domain < 0 ? "-" : std::to_string(run.domain), run.agents,
                     fmt::format("{:.2f} of {} s", run.t_s, ShortestFloat(run.duration_s)), StateOf(run), run.folder,
                     run.page.empty() ? "" : "  " + run.page) +
         (run.vehicles.empty() ? "" : "\n         vehicles: " + run.vehicles);
}

int Ps(bool json) {
  const std::vector<RunningRun> runs = RunsAlive();
  if (json) {
    std::cout << RunsJson(runs) << "\n";
  } else if (runs.empty()) {
    std::cout << "no run is alive\n";
  } else {
    std::cout << fmt::format("{:<8} {:<20} {:>6} {:>6} {:>18}  {:<12} {}\n", "process", "name", "domain", "agents",
                             "time", "state", "folder, page");
    for (const RunningRun& run : runs) std::cout << LineOf(run) << "\n";
  }
  FlushStandardOutput();
  return kExitDone;
}

}  // namespace

std::function<int()> SetUpPs(CLI::App& command) {
  auto json = std::make_shared<bool>(false);
  command.add_flag("--json", *json, "print the list as JSON");
  return [json] { return Ps(*json); };
}

}  // namespace mascot
