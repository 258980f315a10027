#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/python/environment.h"
#include "agent/user_code/last_words.h"
#include "agent/user_code/law_at_work.h"
#include "base/utf8.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/control/run_socket.h"
#include "orchestrator/crazyswarm/crazyswarm_server.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/progress.h"
#include "orchestrator/live/server/address.h"
#include "orchestrator/live/shown/ros_view.h"
#include "orchestrator/live/shown/view_sink.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/report/assertion.h"
#include "orchestrator/report/ending.h"
#include "orchestrator/report/incident_report.h"
#include "orchestrator/report/run_files.h"
#include "orchestrator/report/summary.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/verbs/config_args.h"
#include "orchestrator/verbs/fly.h"
#include "orchestrator/verbs/plot.h"
#include "orchestrator/verbs/verb.h"
#include "orchestrator/verbs/viewers.h"
#include "system/console.h"
#include "system/failure.h"
#include "system/interruptions.h"
#include "system/slurm.h"
#include "system/standard_streams.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

using WallClock = std::chrono::steady_clock;

struct UpArgs {
  ConfigArgs config;
  std::optional<std::string> out;
  ViewerArgs viewers;
  EngineArgs engine{.name = kOverDds, .threads = {}};
  std::vector<std::string> claims;  // --assert
  bool force = false, json = false, quiet = false;
  bool slurm = false;
  bool go = false;
};

/// How many threads the recording keeps busy: what encodes and writes rows, and what compresses them.
int ThreadsOfRecording(const Experiment& experiment) { return experiment.record.topics.empty() ? 0 : 2; }

int ExitCode(const EngineResult& result) {
  if (!result.failure.empty()) return 1;
  return result.signal == 0 ? 0 : 128 + result.signal;
}

/// Makes the plots and keeps or removes the data file, as [output] says. Returns 0, or 128 + signal if plotting was
/// interrupted. Throws std::runtime_error if it failed.
int MakeOutput(const Experiment& experiment, const RunFolder& folder, bool has_rows, StopSignal& stop) {
  const auto& output = experiment.output;
  int code = 0;
  if (has_rows && output.wants_pictures()) code = PlotRun(folder.path(), output.show_plot, stop);
  if (!output.save_data) std::filesystem::remove(folder.File("states.npz"));
  if (code == 0 || code > 128) return code;
  throw std::runtime_error(
      "the pictures could not be made; the data are complete (output.save_plot = false skips them)");
}

/// What is going to happen, in one line.
std::string FirstLine(const Experiment& experiment, const std::string& engine, const RunFolder& folder) {
  return fmt::format("{}: {} agent{} for {:g} s at {} Hz, law {}, {}; results go to {}", experiment.run.name,
                     experiment.size(), experiment.size() == 1 ? "" : "s", experiment.run.duration_s,
                     experiment.control.rate_hz, experiment.law.name,
                     engine == kInProcess ? std::string("in one process")
                                          : fmt::format("over DDS in {}", kModes.Name(experiment.run.mode)),
                     folder.path().string());
}

void SayPythonNote(Console& console) {
  const PythonNote note = NoteOfPython();
  if (!note.used.empty()) console.Line("Python: " + note.used);
  if (!note.warning.empty()) console.Line("warning: " + note.warning);
}

/// The summary of a run whose process ends by force with this exit code, if it is known, for this reason.
std::string SummaryIfKilled(const Experiment& experiment, const std::string& engine, std::optional<int> exit,
                            std::string_view reason) {
  return SummaryOfTheUnknown(experiment, engine, exit,
                             std::string(reason) +
                                 "; the process has ended amid the run, of which only run.mcap, up to its last chunk, "
                                 "and logs are left (orchestrator info, orchestrator recover)");
}

/// `--set hosts=...` that gives each node of the Slurm job an equal share of the agents.
std::string HostsOfTheJob(int agents) {
  std::vector<std::string> nodes = NodesOfTheJob();
  if (std::ssize(nodes) > agents) nodes.resize(static_cast<std::size_t>(agents));
  const int count = static_cast<int>(nodes.size());
  std::string tables;
  for (int k = 0; k < count; ++k)
    tables += fmt::format("{}{{name = '{}', agents = '{}-{}', together = true, launch = ['{}']}}", k == 0 ? "" : ", ",
                          nodes[static_cast<std::size_t>(k)], k * agents / count + 1, (k + 1) * agents / count,
                          fmt::join(OnEachNode(nodes), "', '"));
  return "hosts=[" + tables + "]";
}

/// The experiment; with --slurm, on the nodes of the job.
Experiment Load(UpArgs& args) {
  Experiment experiment = args.config.Load();
  if (!args.slurm) return experiment;
  if (!experiment.hosts.empty())
    throw ConfigError({"--slurm: expected a file without hosts, because the job's nodes are the hosts"});
  if (args.engine.name != kOverDds) throw ConfigError({"--slurm: expected --engine dds, got " + args.engine.name});
  ConfigArgs on_nodes = args.config;
  on_nodes.sets.push_back(HostsOfTheJob(experiment.size()));
  return on_nodes.Load();
}

/// Reads claims about figures that a run of this experiment has.
std::vector<Assertion> ReadClaims(const std::vector<std::string>& texts, const Experiment& experiment,
                                  const Prediction& prediction, const RunMeter& meter) {
  std::vector<Assertion> claims;
  if (texts.empty()) return claims;
  const EngineResult nothing;
  const FlownRun unflown{.experiment = experiment, .prediction = prediction, .meter = meter, .engine = nothing};
  const RunFigures figures(unflown);
  for (const std::string& text : texts) ExpectFigure(claims.emplace_back(ReadAssertion(text)), figures.all());
  return claims;
}

/// Which of the claims do not hold, in words; empty: all do.
std::string FailedClaims(const std::vector<Assertion>& claims, const Figures& figures) {
  std::string failed;
  for (const Assertion& claim : claims)
    if (const std::string why = WhyItFails(claim, figures); !why.empty())
      failed += (failed.empty() ? "" : "; ") + ("--assert " + claim.text + ": " + why);
  return failed;
}

int Up(UpArgs& args) {
  const auto launched = WallClock::now();
  StopSignal stop;
  if (!args.viewers.at && !args.viewers.allowed_origins.empty())
    throw ConfigError({"--allow-origin: expected --view with it"});
  if (!args.viewers.at && args.viewers.watch_only) throw ConfigError({"--watch-only: expected --view with it"});
  if (!args.viewers.at && args.viewers.stay) throw ConfigError({"--stay: expected --view with it"});
  if (!args.viewers.at && !args.viewers.metric_file.empty())
    throw ConfigError({"--metric: expected --view with it (a sweep has own metrics in its table)"});
  std::optional<EndsAtOnce> before_the_run(stop);
  const Experiment experiment = Load(args);
  args.engine.Refuse(experiment, /*gives_actions=*/experiment.network.crazyswarm);
  if (experiment.network.crazyswarm && args.engine.name != kOverDds)
    throw ConfigError({"network.crazyswarm: expected --engine dds with it"});
  Prediction prediction = Predict(experiment);
  before_the_run.reset();

  Console console(args.quiet || args.json);
  Crew crew = args.engine.MakeCrew(experiment, ThreadsOfRecording(experiment));
  RunMeter meter(experiment, crew);
  const std::vector<Assertion> claims = ReadClaims(args.claims, experiment, prediction, meter);
  RunRequests requests(experiment, experiment.run.pace.value_or(args.viewers.at ? 1 : 0));
  if (args.go) requests.LetVehiclesGo();
  Viewers viewers(args.viewers, args.engine.name, experiment, prediction, meter, requests, console);

  const RunFolder folder(args.out, experiment, args.force);
  viewers.LogTo(folder);
  RunFiles files(experiment, folder, meter);
  console.Line(FirstLine(experiment, args.engine.name, folder));
  SayPythonNote(console);
  for (const std::string& warning : prediction.warnings) console.Line("warning: " + warning);
  if (args.engine.name == kOverDds)
    for (const std::string& warning : DeliveryWarnings(experiment)) console.Line("warning: " + warning);
  ExplainCrashes();
  const std::string summary_file = std::filesystem::absolute(folder.File("summary.json")).string();
  std::optional<LastWords> last_words(
      std::in_place, summary_file,
      SummaryIfKilled(experiment, args.engine.name, LastWords::kExitCode, LastWords::kReason));
  Progress progress(experiment, meter, console);
  std::vector<RowSink*> sinks;
  files.AddTo(sinks);
  sinks.insert(sinks.end(), {&progress, &requests});
  viewers.AddTo(sinks);
  std::optional<RosView> ros_view;
  std::optional<ViewSink> ros_sink;
  if (experiment.network.ros_view) {
    ros_view.emplace(experiment, meter);
    sinks.push_back(&ros_sink.emplace(*ros_view, [&ros_view](const std::string& why) { ros_view->Fail(why); }));
  }
  std::optional<CrazyswarmServer> crazyswarm;
  if (experiment.network.crazyswarm)
    sinks.push_back(&crazyswarm.emplace(experiment, [&console](const std::string& words) { console.Warning(words); }));
  const RunSocket socket(experiment, std::filesystem::absolute(folder.path()).string(), args.engine.name, viewers.url(),
                         requests);
  EngineRun flight(args.engine.name, experiment, folder, sinks, &requests, console, stop, crew,
                   ros_view ? &*ros_view : nullptr, crazyswarm ? &*crazyswarm : nullptr);
  flight.LeaveIfKilled(summary_file,
                       SummaryIfKilled(experiment, args.engine.name, std::nullopt,
                                       "the orchestrator was killed (SIGKILL: by somebody, or for want of memory), or "
                                       "code in C of a law has ended it"));
  EngineResult result = flight.Fly();
  console.EndProgress();
  try {
    const Experiment flown = files.Complete(requests.by_hand(), result);
    if (!requests.by_hand().empty()) prediction = Predict(flown);
  } catch (const std::exception& failure) {
    if (result.failure.empty()) result.failure = InWords(failure);
  }
  result.failure = Plain(result.failure);
  last_words.reset();
  const FlownRun flown{.experiment = experiment,
                       .prediction = prediction,
                       .meter = meter,
                       .engine = result,
                       .engine_name = args.engine.name,
                       .topics = files.topics(),
                       .samples = files.samples()};
  if (!claims.empty() && ExitCode(result) == 0) result.failure = FailedClaims(claims, RunFigures(flown).all());
  // Laws that have flown the whole run in this process, perhaps on ideal bodies alone.
  if (ExitCode(result) == 0 && (args.engine.name == kInProcess || experiment.output.fidelity))
    for (const std::string& warning : UnreadParams(experiment)) console.Line("warning: " + warning);
  viewers.SayHowItEnded(result);
  if (!result.failure.empty()) std::cerr << "error: " << result.failure << "\n";

  const Incidents incidents = IncidentsOf(meter, result, requests.numbers_by_hand());
  const RunFigures figures(flown);
  const auto summary = [&](std::optional<int> exit) {
    return SummaryJson(figures, exit, std::chrono::duration<double>(WallClock::now() - launched).count());
  };
  const auto print = [&](const std::string& json) {
    if (args.json)
      std::cout << json;
    else if (!args.quiet)
      std::cout << SummaryText(figures, incidents) << "results        " << folder.path().string() << "\n";
    FlushStandardOutput();
  };
  const auto draw = [&] {
    flight.End(viewers.Stay());  // after the first summary: the DDS library may not let us end in order
    files.WriteTables(incidents);
    return MakeOutput(experiment, folder, files.has_moved(), stop);
  };
  const int code = EndRun(folder, ExitCode(result), {.summary = summary, .draw = draw, .print = print});
  if (code < 128 && files.samples() > 0 && viewers.Stay()) viewers.ShowRecording(folder, stop);
  flight.LeaveByForceIfNeeded(code);
  return code;
}

}  // namespace

std::function<int()> SetUpUp(CLI::App& command) {
  auto args = std::make_shared<UpArgs>();
  args->config.AddTo(command);
  command.add_option("--out", args->out, "folder for the results (default: runs/NAME/TIME)")->type_name("DIR");
  args->engine.AddTo(command, "dds: processes on a bus; inprocess: the same in one process");
  command
      .add_option_function<std::string>(
          "--view", [args](const std::string& address) { args->viewers.at = ReadLiveAddress(address); },
          "serve a page to watch and steer the run, and Foxglove's protocol, at this address (default: 127.0.0.1:8765, "
          "or the next free port)")
      ->expected(0, 1)
      ->type_name("[ADDRESS:PORT]");
  AddAllowOrigin(command, args->viewers.allowed_origins);
  AddWatchOnly(command, args->viewers.watch_only);
  AddMetric(command, args->viewers.metric_file);
  command.add_flag("--go", args->go,
                   "let vehicles take off as soon as all are there; without it they wait for: orchestrator send start");
  command.add_flag("--stay", args->viewers.stay,
                   "with --view: show the recording at the same address when the run has ended, until Ctrl-C; on a "
                   "terminal it is shown anyway if somebody watches");
  command
      .add_option("--assert", args->claims,
                  "fail, with exit code 1, unless this holds of summary.json when the run is over: "
                  "'consensus.settling_time_s < 10'; may be given several times")
      ->type_name("CLAIM")
      ->allow_extra_args(false);
  command.add_flag("--slurm", args->slurm,
                   "inside of a Slurm job: spread the agents evenly over its nodes, by one srun");
  command.add_flag("--force", args->force,
                   "write into a folder that is not empty: files of an earlier run are replaced, other files stay");
  command.add_flag("--json", args->json, "print the summary as JSON on stdout, and nothing else");
  command.add_flag("--quiet", args->quiet, "print errors only");
  return [args] { return Up(*args); };
}

}  // namespace mascot
