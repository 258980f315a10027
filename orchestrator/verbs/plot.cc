#include "orchestrator/verbs/plot.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/processes/script.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct PlotArgs {
  std::string run;
  bool show = false;
};

}  // namespace

int PlotRun(const fs::path& folder, bool show, StopSignal& stop) {
  std::vector<std::string> arguments{folder};
  if (show) arguments.push_back("--show");
  return RunScript("plot.py", arguments, stop);
}

std::function<int()> SetUpPlot(CLI::App& command) {
  auto args = std::make_shared<PlotArgs>();
  command.add_option("run", args->run, "run folder")->required()->type_name("RUN");
  command.add_flag("--show", args->show, "open windows too");
  return [args] {
    if (!fs::is_directory(args->run)) throw ConfigError({args->run + ": expected a run folder"});
    StopSignal stop;
    return PlotRun(args->run, args->show, stop);
  };
}

}  // namespace mascot
