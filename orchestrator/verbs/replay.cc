// `orchestrator replay RUN`: puts a recording back on DDS, or lets one agent live through it.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "base/number.h"
#include "bus/leave.h"
#include "experiment/read_experiment.h"
#include "orchestrator/engines/dds/player.h"
#include "orchestrator/engines/dds/row_player.h"
#include "orchestrator/recording/decisions.h"
#include "orchestrator/recording/fingerprint.h"
#include "orchestrator/recording/recorded_experiment.h"
#include "orchestrator/recording/recorded_life.h"
#include "orchestrator/recording/recording.h"
#include "orchestrator/report/json.h"
#include "orchestrator/verbs/config_args.h"
#include "orchestrator/verbs/verb.h"
#include "system/environment.h"
#include "system/interruptions.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct ReplayArgs {
  std::string run;
  std::optional<int> agent;
  bool debug = false;
  std::string program;            // --agent
  std::string law;                // a file
  std::vector<std::string> sets;  // as typed
  std::optional<std::string> speed;
  std::vector<std::string> await;
  std::optional<int> domain;
  bool json = false, quiet = false;
};

/// How long an agent that is not simply the program of this build may take: by an emulator, in a debugger.
struct Patience {
  double answer_s, start_s;
};
constexpr Patience kPatienceWithPrograms{120, 600}, kPatienceInDebuggers{3600, 3600};

/// Throws ConfigError for options that do not go together.
void RefuseCombinations(const ReplayArgs& args) {
  const auto refuse = [](bool given, const std::string& option, const std::string& words) {
    if (given) throw ConfigError({option + ": " + words});
  };
  if (args.agent) {
    const std::string why = "expected without --to: the agent gets the next tick when it has answered";
    refuse(args.speed.has_value(), "--speed", why);
    refuse(!args.await.empty(), "--wait-for", why);
    refuse(args.debug && !args.program.empty(), "--debug",
           "expected without --agent: a debugger for that program is part of its command");
    return;
  }
  const std::string why = "expected --to AGENT with it";
  refuse(args.debug, "--debug", why);
  refuse(!args.program.empty(), "--agent", why);
  refuse(!args.law.empty(), "--law", why);
  refuse(!args.sets.empty(), "--set", why);
  refuse(args.json, "--json", why);
}

/// Throws ConfigError if there is no gdb in PATH.
void RequireGdb() {
  if (FindInPath("gdb").empty())
    throw ConfigError({"--debug: expected the debugger gdb, which is not installed (apt install gdb)"});
}

double ReadSpeed(const std::string& text) {
  if (text == "fastest") return 0;
  const auto speed = NumberFrom<double>(text);
  if (speed && *speed >= 0 && *speed <= 1e6) return *speed;
  throw ConfigError(
      {"--speed: expected recorded seconds a second, up to 1e6, or 0 or fastest: as fast as listeners take "
       "samples, got '" +
       text + "'"});
}

/// A recording, and what is attached to it.
struct ReplaySubject {
  std::string file;
  McapContents contents;
  RecordingPlan plan;
};

ReplaySubject ReplaySubjectOf(const std::string& run) {
  ReplaySubject subject{.file = FindRecording(run), .contents = {}, .plan = {}};
  subject.contents = ReadRecording(subject.file);
  subject.plan = PlanOf(subject.contents, subject.file);
  return subject;
}

// --- one agent ----------------------------------------------------------------------------------------

/// What the replay changes in the recorded experiment: where its processes are, what the user wants changed, and, for
/// other programs, how long everybody waits.
std::vector<Override> OverridesOf(const ReplayArgs& args, const ReplaySubject& subject) {
  std::vector<Override> changes{{.key = "hosts", .value = "", .removes = true},
                                {.key = "network.agents_per_process", .value = "1"},
                                {.key = "network.security", .value = "\"off\""},  // one participant is all the others
                                {.key = "network.protection", .value = "\"none\""},
                                {.key = "network.ros_view", .value = "false"}};
  if (args.domain)
    changes.push_back({"network.domain", std::to_string(*args.domain), "--domain " + std::to_string(*args.domain)});
  if (args.debug || !args.program.empty()) {
    const Patience& least = args.debug ? kPatienceInDebuggers : kPatienceWithPrograms;
    const Experiment as_it_was =
        LoadExperiment(Section::FromText(subject.contents.attachments.at(kConfigFile), subject.file), subject.plan.name,
                       /*checked=*/true);
    const auto at_least = [&](const std::string& key, double own, double wanted) {
      changes.push_back({.key = key, .value = ShortestFloat(std::max(own, wanted))});
    };
    at_least("run.agent_timeout_s", as_it_was.run.agent_timeout_s, least.answer_s);
    at_least("run.start_timeout_s", as_it_was.run.start_timeout_s, least.start_s);
    changes.push_back({.key = "network.transport", .value = "\"udp\""});  // its shared memory may be of another kind
  }
  if (!args.law.empty()) {
    const std::string key = fs::path(args.law).extension() == ".so" ? "law.library" : "law.file";
    changes.push_back({key, ToToml(Value{fs::absolute(args.law).string()}), "--law " + args.law});
  }
  for (const std::string& set : args.sets) changes.push_back(ParseOverride(set));
  return changes;
}

/// Throws ConfigError if what was recorded does not fit the experiment any more.
void RequireSameTicks(const Experiment& experiment, const RecordingPlan& plan) {
  const auto require = [](const char* key, auto ours, auto recorded) {
    if (ours != recorded)
      throw ConfigError({fmt::format("--set: {}: expected {}, as in the recording, got {}", key, recorded, ours)});
  };
  require("agents.count", experiment.size(), plan.agents);
  require("control.rate_hz", experiment.control.rate_hz, plan.rate_hz);
  require("run.duration_s", ShortestFloat(experiment.time_s(experiment.ticks())),
          ShortestFloat(static_cast<double>(plan.ticks - 1) / plan.rate_hz));
}

Json PairJson(const Decisions::Pair& pair, int rate_hz) {
  return {{"tick", pair.tick},         {"t_s", static_cast<double>(pair.tick) / rate_hz},
          {"part", pair.part},         {"recorded", pair.recorded},
          {"replayed", pair.replayed}, {"difference", pair.difference()}};
}

Json ReplayJson(const ReplaySubject& subject, int agent, const Decisions& decisions, const Player::Result& result) {
  const int rate_hz = subject.plan.rate_hz;
  const auto text_or_null = [](const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); };
  Json first = nullptr;
  if (const auto& found = decisions.first())
    first = {{"tick", found->tick},
             {"t_s", static_cast<double>(found->tick) / rate_hz},
             {"topic", found->topic},
             {"field", found->difference.field},
             {"recorded", found->difference.first},
             {"replayed", found->difference.second}};
  Json fields = Json::array();
  for (const Decisions::Field& field : decisions.DifferingFields())
    fields.push_back({{"field", field.name},
                      {"unit", text_or_null(std::string(field.unit))},
                      {"ticks", field.ticks},
                      {"first", PairJson(field.first, rate_hz)},
                      {"largest", PairJson(field.largest, rate_hz)}});
  return {{"recording", subject.file},
          {"agent", agent},
          {"ticks", decisions.ticks()},
          {"differing_ticks", decisions.differing()},
          {"first", first},
          {"fields", fields},
          {"processes", result.processes},
          {"lost_ticks", result.lost},
          {"missed_ticks", result.missed},
          {"failure", text_or_null(result.failure)},
          {"loss", text_or_null(LossOf(subject.contents))}};
}

/// "2001 ticks"; "1901 of 2001 ticks; it was lost at the others, and had 2 processes"
std::string ExtentOfReplay(const Decisions& decisions, const Player::Result& result) {
  std::string words = fmt::format("{} ticks", decisions.ticks());
  if (result.lost > 0)
    words += fmt::format("; it was lost at {} others, and had {} processes", result.lost, result.processes);
  if (result.missed > 0) words += fmt::format("; it had missed {} others", result.missed);
  return words;
}

void PrintDifferences(const ReplaySubject& subject, int agent, const Decisions& decisions) {
  const int rate_hz = subject.plan.rate_hz;
  const auto time = [rate_hz](std::int64_t tick) { return ShortestFloat(static_cast<double>(tick) / rate_hz); };
  const Decisions::First& first = *decisions.first();
  std::cout << fmt::format(
                   "{}: agent {} decides otherwise from tick {} ({} s) on: {}: {} is {} in the recording, {} now\n",
                   subject.file, agent, first.tick, time(first.tick), first.topic, first.difference.field,
                   first.difference.first, first.difference.second)
            << fmt::format("{} of {} ticks differ\n", decisions.differing(), decisions.ticks());
  for (const Decisions::Field& field : decisions.DifferingFields()) {
    const std::string unit = field.unit.empty() ? "" : " " + std::string(field.unit);
    const auto by = [&](const Decisions::Pair& pair) {
      return fmt::format("by {}{} ({}{} at {} s)", ShortestFloat(pair.difference()), unit, field.name, pair.part,
                         time(pair.tick));
    };
    std::cout << fmt::format("  {}: at {} ticks, first {}, most {}\n", field.name, field.ticks, by(field.first),
                             by(field.largest));
  }
}

/// Prints the outcome, and returns the exit code.
int ReportReplay(const ReplayArgs& args, const ReplaySubject& subject, const Decisions& decisions,
                 const Player::Result& result) {
  const int agent = *args.agent;
  const std::string loss = LossOf(subject.contents);
  if (args.json)
    std::cout << JsonText(ReplayJson(subject, agent, decisions, result)) << std::flush;
  else if (decisions.first())
    PrintDifferences(subject, agent, decisions);
  else if (decisions.ticks() > 0)
    std::cout << fmt::format("{}: agent {} decides the same, bit for bit: {}\n", subject.file, agent,
                             ExtentOfReplay(decisions, result));
  const bool is_damaged = !subject.contents.damage.empty() && !subject.contents.cut;
  if (!args.json && !loss.empty())
    std::cout << subject.file << (is_damaged ? ": damaged: " : ": cut: ") << loss << "\n";
  std::cout << std::flush;
  if (!result.failure.empty()) std::cerr << "error: " << result.failure << std::endl;
  if (result.signal != 0) return 128 + result.signal;
  if (decisions.first() || !result.failure.empty() || is_damaged) return kExitFailed;
  return loss.empty() ? kExitDone : kExitIncomplete;
}

int ReplayAgent(const ReplayArgs& args, StopSignal& stop) {
  std::optional<EndsAtOnce> before_the_replay(stop);
  if (args.debug) RequireGdb();
  const ReplaySubject subject = ReplaySubjectOf(args.run);
  if (*args.agent < 1 || *args.agent > subject.plan.agents)
    throw ConfigError({fmt::format("--to: expected an agent of 1 to {}, got {}", subject.plan.agents, *args.agent)});
  const std::vector<Override> changes = OverridesOf(args, subject);
  const bool changes_law = !args.law.empty() || !args.sets.empty();
  const auto [experiment, change] = ReadRecordedExperiment(
      args.run, subject.file, subject.contents, [&](const std::string& toml, const std::string& name) {
        return LoadExperiment(Section::FromText(toml, name, changes), subject.plan.name, /*checked=*/!changes_law);
      });
  if (!change.empty())
    throw ConfigError({subject.file + ": config.toml beside it is of another experiment: " + change +
                       "; `orchestrator replay " + subject.file + "` takes the recording alone"});
  RequireSameTicks(experiment, subject.plan);
  RecordedLife life(subject.file, subject.contents, subject.plan, experiment, *args.agent);
  Console console(args.quiet || args.json);
  for (const std::string& note : ChangesSince(subject.contents, experiment, "replayed")) console.Line("note: " + note);
  before_the_replay.reset();
  Player::Program program{.command = args.program, .debugger = {}};
  if (args.debug) program.debugger = {"gdb", "--args"};
  Decisions decisions;
  Player player(life, experiment, *args.agent, program, decisions, console, stop);
  Player::Result result = player.Play();
  const bool let_go = player.End();
  const int code = ReportReplay(args, subject, decisions, result);
  if (!let_go) LeaveNow({.code = code, .process = "orchestrator"});  // threads use what would be destroyed
  return code;
}

// --- all samples --------------------------------------------------------------------------------------

/// The experiment in the config.toml of the run's folder, which has its domain, or else in the recording. No code of
/// users runs.
Experiment AsTheRunWas(const std::string& run, const ReplaySubject& subject) {
  const fs::path folder = FindRun(run), path = folder / "config.toml";
  const bool is_there = fs::is_directory(folder) && fs::exists(path);
  const std::string& attached = subject.contents.attachments.at(kConfigFile);
  return ReadWithoutLaws(
      Section::FromText(is_there ? ReadRegularFile(path.string()) : attached, is_there ? path.string() : subject.file),
      subject.plan.name);
}

int ReplaySamples(const ReplayArgs& args, StopSignal& stop) {
  std::optional<EndsAtOnce> before_the_replay(stop);
  RowPlayer::Options options;
  options.speed = ReadSpeed(args.speed.value_or("1"));
  const ReplaySubject subject = ReplaySubjectOf(args.run);
  options.file = subject.file;
  const Experiment experiment = AsTheRunWas(args.run, subject);
  options.wanted_domain = args.domain.value_or(experiment.network.domain);
  options.transport = experiment.network.transport;
  for (const std::string& name : args.await) {
    const auto is_it = [&](const auto& channel) { return channel.second.topic == name; };
    if (std::ranges::none_of(subject.contents.channels, is_it))
      throw ConfigError({"--wait-for: expected a topic of the recording, such as /clock, got '" + name +
                         "' (`orchestrator info` lists them)"});
    options.await.push_back(name);
  }
  Console console(args.quiet);
  if (const std::string loss = LossOf(subject.contents); !loss.empty())
    console.Warning("warning: " + subject.file + ": " + loss + "; it plays up to there");
  before_the_replay.reset();
  RowPlayer player(subject.contents, options, console, stop);
  const RowPlayer::Result result = player.Play();
  const bool let_go = player.End();
  int code = kExitDone;
  if (!result.failure.empty()) {
    std::cerr << "error: " << result.failure << std::endl;
    code = kExitFailed;
  }
  if (result.signal != 0) code = 128 + result.signal;
  std::cout << fmt::format("{}: {} samples of {} s\n", subject.file, result.samples, ShortestFloat(result.recorded_s))
            << std::flush;
  if (!let_go) LeaveNow({.code = code, .process = "orchestrator"});  // threads use what would be destroyed
  return code;
}

int Replay(const ReplayArgs& args) {
  StopSignal stop;
  RefuseCombinations(args);
  return args.agent ? ReplayAgent(args, stop) : ReplaySamples(args, stop);
}

}  // namespace

std::function<int()> SetUpReplay(CLI::App& command) {
  auto args = std::make_shared<ReplayArgs>();
  command.add_option("run", args->run, "a run folder, a folder of runs or 'latest' for the newest, or an .mcap file")
      ->required()
      ->type_name("RUN");
  command.add_option("--to", args->agent, "lets the process of this agent live through the recording, and compares")
      ->type_name("AGENT");
  command.add_flag("--debug", args->debug,
                   "with --to: the agent runs in gdb, on this terminal; nothing is bounded in time");
  command
      .add_option("--agent", args->program,
                  "with --to: another agent program, as a command of the shell, to which arguments are added")
      ->type_name("COMMAND");
  command.add_option("--law", args->law, "with --to: the law as it is in this file now, in Python, or a library (.so)")
      ->type_name("FILE");
  command.add_option("--set", args->sets, "with --to: replaces or adds a key: --set law.p_gain=0.5")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_flag("--json", args->json, "with --to: prints the comparison as JSON, and nothing else");
  command
      .add_option(
          "--speed", args->speed,
          "without --to: recorded seconds a second (default: 1); 0 or fastest: as fast as listeners take samples")
      ->type_name("X");
  command
      .add_option("--wait-for", args->await,
                  "without --to: begins when somebody listens to this topic; may be given several times")
      ->type_name("TOPIC")
      ->allow_extra_args(false);
  command
      .add_option("--domain", args->domain,
                  "the DDS domain (default: network.domain of the run, or a free one; it is printed)")
      ->check(CLI::Range(0, 232))
      ->type_name("D");
  command.add_flag("--quiet", args->quiet, "prints no progress");
  command.footer(
      "With --to, exit codes: 0 the agent decides the same bits, 1 it decides otherwise, or the replay has failed, 2 "
      "the\n"
      "recording does not hold what the agent heard, 3 the recording was cut, and up to there it decides the same.\n"
      "docs/replay.md has an example.");
  return [args] { return Replay(*args); };
}

}  // namespace mascot
