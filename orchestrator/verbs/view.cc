// `orchestrator view RUN`: serves the page of a run on its recording, with a time line.
#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "orchestrator/verbs/show_recording.h"
#include "orchestrator/verbs/verb.h"
#include "orchestrator/verbs/viewers.h"

namespace mascot {
namespace {

struct ViewArgs {
  std::string run;
  LiveAddress at;
  std::vector<std::string> allowed_origins;
  bool watch_only = false;
  std::string metric_file;
};

int View(const ViewArgs& args) {
  StopSignal stop;
  Console console(/*quiet=*/false);
  const std::unique_ptr<const PythonMetrics> metrics = MetricsOf(args.metric_file);
  const Showing showing{.at = args.at,
                        .allowed_origins = args.allowed_origins,
                        .steering = SteeringFor(args.watch_only),
                        .metrics = metrics.get()};
  const int signal = ShowRecording(args.run, showing, "--at", stop, console);
  return signal == 0 ? kExitFailed : 128 + signal;
}

}  // namespace

std::function<int()> SetUpView(CLI::App& command) {
  auto args = std::make_shared<ViewArgs>();
  command.add_option("run", args->run, "a run folder, a folder of runs or 'latest' for the newest, or an .mcap file")
      ->required()
      ->type_name("RUN");
  command
      .add_option_function<std::string>(
          "--at", [args](const std::string& address) { args->at = ReadLiveAddress(address, "--at"); },
          "where to listen (default: 127.0.0.1:8765, or the next free port)")
      ->type_name("ADDRESS:PORT");
  AddAllowOrigin(command, args->allowed_origins);
  AddWatchOnly(command, args->watch_only);
  AddMetric(command, args->metric_file);
  command.footer(
      "Serves the page of a run, and Foxglove's protocol, until Ctrl-C. Only the recording is read, and of it the "
      "parts\nthat are looked at; what was cut short plays up to the cut. docs/live.md says what is to be seen.");
  return [args] { return View(*args); };
}

}  // namespace mascot
