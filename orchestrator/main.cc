#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "bus/foreign_settings.h"
#include "bus/leave.h"
#include "experiment/toml/section.h"
#include "orchestrator/verbs/law_trial.h"
#include "orchestrator/verbs/verb.h"
#include "system/descendants.h"
#include "system/failure.h"
#include "system/private_folder.h"
#include "system/standard_streams.h"
#include "system/usage.h"

namespace mascot {
namespace {

// All verbs; `orchestrator --help` prints this table.
constexpr VerbEntry kVerbs[] = {
    {"up", "run an experiment: start its processes, record, measure, draw", SetUpUp},
    {"ps", "the runs that are alive on this machine", SetUpPs},
    {"send", "steer a run that is alive: pause, pace, set a key, send an agent somewhere", SetUpSend},
    {"check", "validate an experiment and say what theory predicts; starts nothing", SetUpCheck},
    {"graph", "matrices, lambda_2, components and roots of an experiment's graph", SetUpGraph},
    {"laws", "the control laws: equation, source, parameters", SetUpLaws},
    {"models", "the agent models", SetUpModels},
    {"airframes", "the built-in quadrotors: parameters, gains, limits", SetUpAirframes},
    {"keys", "the keys of an experiment file: value, default, meaning", SetUpKeys},
    {"new", "write a commented experiment with a law, to begin with", SetUpNew},
    {"info", "what a recording holds, and whether it is complete, with the proof", SetUpInfo},
    {"runs", "list the runs in a folder, remove some, keep notes", SetUpRuns},
    {"plot", "draw the pictures of a run again", SetUpPlot},
    {"view", "play a recording on the page of a run", SetUpView},
    {"serve", "let another program step a team: MATLAB, Simulink, or any that speaks JSON", SetUpServe},
    {"fmu", "make an FMU of a team, which tools that know FMI 2 or 3 step", SetUpFmu},
    {"sweep", "run an experiment over values of its keys and seeds: a table, a picture", SetUpSweep},
    {"tune", "search for the values of keys that make a figure smallest or largest", SetUpTune},
    {"compare", "the summaries of several runs side by side", SetUpCompare},
    {"verify", "fly a recorded experiment again, and compare bit for bit", SetUpVerify},
    {"replay", "play a recording on DDS, or let one agent live through it again and compare", SetUpReplay},
    {"recover", "make a whole recording of what a cut or damaged one still holds", SetUpRecover},
    {"export", "write a recording as NumPy arrays, as CSV or as a MATLAB file", SetUpExport},
    {"host", "fly one host's share of a run; `up` starts it, nobody types it", SetUpHost},
};

bool IsVerb(std::string_view word) {
  return std::ranges::any_of(kVerbs, [word](const VerbEntry& verb) { return verb.name == word; });
}

/// Reports an unknown verb and returns the exit code. CLI11's own error only says that a subcommand is required.
int UnknownVerb(const std::string& word) {
  std::vector<std::string_view> names;
  for (const VerbEntry& verb : kVerbs) names.push_back(verb.name);
  const auto near = DidYouMean(word, names);
  std::cerr << "error: unknown verb '" << word << "'";
  if (near) std::cerr << " (did you mean \"" << *near << "\"?)";
  std::cerr << "; expected one of";
  for (std::string_view name : names) std::cerr << (name == names.front() ? " " : ", ") << name;
  std::cerr << "\n";
  return kExitUsage;
}

/// `orchestrator help [VERB]`: as --help and VERB --help. Returns the exit code.
int Help(const CLI::App& app, const std::string& verb) {
  if (!verb.empty() && !IsVerb(verb)) return UnknownVerb(verb);
  std::cout << (verb.empty() ? app.help() : app.get_subcommand(verb)->help(app.get_name()));
  FlushStandardOutput();
  return kExitDone;
}

int Main(int argc, char** argv) {
  CLI::App app("MASCOT: a testbed for decentralised control of multi-agent systems.", "orchestrator");
  app.set_version_flag("--version", std::string("mascot ") + MASCOT_VERSION);
  app.require_subcommand(1);
  app.footer("orchestrator help VERB: the arguments of one of them");
  std::function<int()> action;
  for (const VerbEntry& verb : kVerbs) {
    CLI::App& command = *app.add_subcommand(std::string(verb.name), std::string(verb.summary));
    command.callback([&action, run = verb.set_up(command)] { action = run; });
  }
  if (argc < 2) {
    std::cerr << app.help();
    return kExitUsage;
  }
  if (argv[1] == std::string_view("help")) return Help(app, argc > 2 ? argv[2] : "");
  if (argc == 3 && argv[1] == std::string_view(kTrialFlight)) return FlyTrial(argv[2]);
  if (argv[1][0] != '-' && !IsVerb(argv[1])) return UnknownVerb(argv[1]);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << UsageText(app, error) << "\n";
    return kExitUsage;
  }
  const int code = action();
  FlushStandardOutput();
  return code;
}

}  // namespace
}  // namespace mascot

int main(int argc, char** argv) {
  const int code = mascot::ExitCodeOf([&] {
    mascot::OpenStandardStreams();
    mascot::FitStandardStreams();
    mascot::ForgetForeignSettings();
    std::signal(SIGCHLD, SIG_DFL);  // some supervisors leave it ignored; then waitpid cannot tell how a child ended
    std::signal(SIGPIPE, SIG_IGN);  // a closed terminal or pager must not kill the run
    std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the file size limit then fails with EFBIG, which is reported
    mascot::SayWhatIsUncaught();
    mascot::AdoptDescendants();
    mascot::MarkDescendants();  // before a law is looked at
    return mascot::Main(argc, argv);
  });
  mascot::KillDescendants();
  mascot::SweepPrivateFolders();  // of processes that were killed
  mascot::LeaveWithin(std::chrono::seconds(5), {.code = code, .process = "orchestrator", .on_signals = true});
  return code;  // and destroy what the DDS library keeps in static variables
}
