// `orchestrator verify RUN`: flies the experiment of a recording again, and compares bit for bit.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/engines/scene_edges.h"
#include "orchestrator/recording/attached_experiment.h"
#include "orchestrator/recording/compare.h"
#include "orchestrator/recording/fingerprint.h"
#include "orchestrator/recording/recorded_actions.h"
#include "orchestrator/recording/recorded_experiment.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/verbs/fly.h"
#include "orchestrator/verbs/law_trial.h"
#include "orchestrator/verbs/verb.h"
#include "system/interruptions.h"
#include "system/private_folder.h"

namespace mascot {
namespace {

struct VerifyArgs {
  std::string run;
  EngineArgs engine{.name = kInProcess, .threads = {}};
  bool uses_hosts = false;
};

/// A recording that can be verified.
struct Subject {
  std::string file;
  McapContents contents;
  RecordingPlan plan;
  std::uint64_t ticks = 0;  ///< ticks up to the last of which it has samples
};

/// Throws ConfigError for what cannot be verified.
Subject SubjectOf(const std::string& run) {
  Subject subject;
  subject.file = FindRecording(run);
  subject.contents = ReadRecording(subject.file);
  subject.plan = PlanOf(subject.contents, subject.file);
  if (subject.plan.realtime)
    throw ConfigError({subject.file + ": expected run.mode = \"lockstep\", got \"realtime\": such a run depends on the "
                                      "wall clock, and never repeats bit for bit"});
  subject.ticks = TicksBegun(subject.contents, subject.plan);
  if (subject.ticks == 0) {
    const std::string loss = LossOf(subject.contents);
    const char* reason = TicksOfEarlyEnd(subject.contents) == std::uint64_t{0} ? "the run ended before its first tick"
                                                                               : "record.topics left them out";
    throw ConfigError({subject.file + ": expected a recording with messages, got none" +
                       (loss.empty() ? std::string("; ") + reason : ": " + loss)});
  }
  return subject;
}

/// Reads an experiment that is to fly no more ticks than the recording has: a run that ended early, or a recording that
/// was cut, is flown to its end, with the events up to there.
Experiment Load(const std::string& toml, const std::string& name, const Subject& subject, bool uses_hosts) {
  std::vector<Override> changes;
  if (!uses_hosts) changes.push_back({.key = "hosts", .value = "", .removes = true});
  Experiment whole = LoadExperiment(Section::FromText(toml, name, changes), subject.plan.name);
  if (subject.ticks >= subject.plan.ticks) return whole;
  const auto last = static_cast<std::int64_t>(std::max<std::uint64_t>(subject.ticks - 1, 1));
  return LoadExperiment(Section::FromText(StoppedAfter(whole, last), name), subject.plan.name, /*checked=*/true);
}

/// "813 of 4001 ticks, 7317 messages"; "4001 ticks, of which 401 have a row, 3609 messages"
std::string Extent(const Subject& subject, const Comparison& comparison) {
  const auto ticks = static_cast<std::uint64_t>(comparison.ticks());
  return fmt::format("{}{} ticks, {}{} messages", ticks,
                     ticks < subject.plan.ticks ? fmt::format(" of {}", subject.plan.ticks) : "",
                     subject.plan.ticks_per_row > 1 ? fmt::format("of which {} have a row, ", comparison.rows()) : "",
                     comparison.messages());
}

/// What is to be said of the file itself, whatever was compared, and the exit code of a recording that does not differ.
std::pair<std::string, int> StateOf(const Subject& subject) {
  const McapContents& contents = subject.contents;
  const std::string loss = LossOf(contents);
  if (loss.empty()) return {"", kExitDone};
  if (contents.damage.empty() || contents.cut) return {"cut: " + loss, kExitIncomplete};
  return {"damaged: " + loss, kExitFailed};
}

/// What is to be said of a whole file that does not differ as far as it goes, and the exit code.
std::pair<std::string, int> EndOf(const Subject& subject) {
  const std::string gap = Judge(subject.file, subject.contents).reason;
  if (!gap.empty()) return {"incomplete: " + gap, kExitFailed};
  return {subject.ticks < subject.plan.ticks ? "the run ended early" : "", kExitDone};
}

/// Prints the outcome, and returns the exit code.
int Report(const Subject& subject, const Comparison& comparison, const EngineResult& result) {
  const auto say = [&](const std::string& words) {
    if (!words.empty()) std::cout << subject.file << ": " << words << std::endl;
  };
  const std::string extent = Extent(subject, comparison);
  auto [state, code] = StateOf(subject);
  if (!comparison.difference().empty()) {
    say("differs: " + comparison.difference());
    code = kExitFailed;
  } else if (!result.failure.empty()) {
    say("differs: it goes on after " + extent + ", where the run now fails: " + result.failure);
    code = kExitFailed;
  } else if (result.signal != 0) {
    say("interrupted: the same so far, " + extent);
    code = 128 + result.signal;
  } else {
    say("the same, bit for bit: " + extent);
    if (state.empty()) std::tie(state, code) = EndOf(subject);
  }
  say(state);
  return code;
}

int Verify(const VerifyArgs& args) {
  StopSignal stop;
  std::optional<EndsAtOnce> before_the_run(stop);
  const Subject subject = SubjectOf(args.run);
  const auto [experiment, change] = ReadRecordedExperiment(
      args.run, subject.file, subject.contents,
      [&](const std::string& toml, const std::string& name) { return Load(toml, name, subject, args.uses_hosts); });
  if (!change.empty()) {
    std::cout << subject.file << ": config.toml beside it is of another experiment: " << change << "\n"
              << "`orchestrator verify " << subject.file << "` checks the recording alone" << std::endl;
    return kExitFailed;
  }
  args.engine.Refuse(experiment, /*gives_actions=*/true);
  std::optional<RecordedActions> actions;
  if (TakesActions(experiment)) actions.emplace(subject.file, subject.plan, experiment);
  for (const std::string& note : ChangesSince(subject.contents, experiment, "flown again"))
    std::cout << "note: " << note << "\n";
  before_the_run.reset();
  const PrivateFolder temporary;  // for the logs of the second flight, which are not kept
  const RunFolder folder((temporary.path() / "run").string(), experiment, /*force=*/false);
  Console console(/*quiet=*/true);
  Comparison comparison(subject.file, subject.plan, TicksIn(subject.contents, subject.plan), experiment);
  std::vector<RowSink*> sinks;
  std::optional<SceneEdges> edges;
  if (comparison.edges() != nullptr) sinks.push_back(&edges.emplace(experiment, *comparison.edges()));
  sinks.push_back(&comparison);
  Crew crew = args.engine.MakeCrew(experiment, /*others=*/0);
  EngineRun flight(args.engine.name, experiment, folder, sinks, nullptr, console, stop, crew,
                   /*ros=*/nullptr, actions ? &*actions : nullptr);
  EngineResult result = flight.Fly();
  // Who has not answered the last tick is lost by events of the next one (StoppedAfter()): what fails there is behind
  // the recording.
  const bool has_all = std::cmp_equal(comparison.ticks(), subject.ticks);
  if (has_all && std::cmp_greater_equal(experiment.ticks(), subject.ticks)) result.failure.clear();
  if (result.failure.empty() && result.signal == 0) comparison.Finish();
  const int code = Report(subject, comparison, result);
  if (code == kExitFailed)
    if (const std::string cause = TryLaws(experiment).difference; !cause.empty())
      std::cout << "a likely cause: " << cause << std::endl;
  flight.End(/*process_goes_on=*/false);
  flight.LeaveByForceIfNeeded(code);
  return code;
}

}  // namespace

std::function<int()> SetUpVerify(CLI::App& command) {
  auto args = std::make_shared<VerifyArgs>();
  command.add_option("run", args->run, "a run folder, a folder of runs or 'latest' for the newest, or an .mcap file")
      ->required()
      ->type_name("RUN");
  args->engine.AddTo(command, "inprocess (default): in one process; dds: processes on a bus. Whichever recorded it");
  command.add_flag("--hosts", args->uses_hosts,
                   "with --engine dds: agents fly on the hosts of the run's config.toml, by its launch commands");
  command.footer(
      "Flies the experiment that is attached to the recording, as far as the recording goes, and compares every\n"
      "message as it comes. Writes no file. Exit codes: 0 the same bits, 1 something differs or is damaged, 2 it is "
      "no\n"
      "recording that could repeat, 3 the recording was cut, and what is left of it is the same.");
  return [args] { return Verify(*args); };
}

}  // namespace mascot
