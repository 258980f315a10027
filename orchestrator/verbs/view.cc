// `orchestrator view RUN`: serves the page of a run on its recording, with a time line.
#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "orchestrator/live/recorded/playback.h"
#include "orchestrator/live/recorded/projector.h"
#include "orchestrator/live/recorded/recorded_run.h"
#include "orchestrator/live/server/address.h"
#include "orchestrator/live/shown/live_view.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/verbs/verb.h"
#include "orchestrator/verbs/viewers.h"
#include "system/console.h"
#include "system/interruptions.h"
#include "system/script.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

struct ViewArgs {
  std::string run;
  LiveAddress at;
  std::vector<std::string> allowed_origins;
  bool watch_only = false;
};

/// Returns the exit code: a signal ends the view, or an error of ours has.
int WaitForTheEnd(StopSignal& stop, const LiveView& view) {
  constexpr auto kLook = std::chrono::milliseconds(200);
  while (!view.has_failed())
    if (const int signal = stop.Within(kLook); signal != 0) return 128 + signal;
  return 1;
}

int View(const ViewArgs& args) {
  StopSignal stop;
  Console console(/*quiet=*/false);
  const auto log = [&console](const std::string& line) { console.Line(line); };
  std::optional<EndsAtOnce> before_the_view(stop);
  RecordedRun run(args.run);
  if (!run.rows().loss().empty())
    console.Line("warning: " + run.rows().path() + ": " + run.rows().loss() + "; it plays up to there");
  const Prediction prediction = Predict(run.experiment());
  before_the_view.reset();
  Playback playback(run.experiment().control.rate_hz, run.last_tick());
  const LiveView::Options options{.address = args.at.address,
                                  .port = args.at.port,
                                  .allowed_origins = args.allowed_origins,
                                  .page = FindShared("page", "orchestrator/live"),
                                  .source = {.recorded = run.part()},
                                  .pace = 1,
                                  .steering = args.watch_only ? Steering::By::kToken : Steering::By::kAll};
  const auto view = [&] {
    try {
      return std::make_unique<LiveView>(run.experiment(), prediction, playback, options, log);
    } catch (const std::runtime_error& failure) {
      throw ConfigError({std::string("--at: ") + failure.what()});
    }
  }();
  const Projector projector(run, playback, *view, log);
  PrintAddresses(*view, console);
  return WaitForTheEnd(stop, *view);
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
  command.footer(
      "Serves the page of a run, and Foxglove's protocol, until Ctrl-C. Only the recording is read, and of it the "
      "parts\nthat are looked at; what was cut short plays up to the cut. docs/live.md says what is to be seen.");
  return [args] { return View(*args); };
}

}  // namespace mascot
