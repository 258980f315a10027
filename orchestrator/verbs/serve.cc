// `orchestrator serve CONFIG`: a team that waits to be stepped by another program (docs/serve.md).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/user_code/law_at_work.h"
#include "bus/leave.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/live/server/address.h"
#include "orchestrator/live/server/origin.h"
#include "orchestrator/serving/server.h"
#include "orchestrator/serving/team_service.h"
#include "orchestrator/verbs/config_args.h"
#include "orchestrator/verbs/one_of.h"
#include "orchestrator/verbs/verb.h"
#include "system/console.h"
#include "system/interruptions.h"
#include "system/standard_streams.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

constexpr std::uint16_t kServePort = 8770;

struct ServeArgs {
  ConfigArgs config;
  LiveAddress at{.port = kServePort};
  std::vector<int> ports;
  std::string engine = kInProcess;
  std::optional<std::string> out;
  bool once = false, json = false;
};

int Serve(ServeArgs& args) {
  StopSignal stop;
  Console console(args.json);
  std::optional<EndsAtOnce> before_serving(stop);
  std::optional<Interruptions> interruptions;  // once it serves
  const auto goes_on = [&] { return !interruptions || interruptions->signal() == 0; };
  TeamService team({.text = args.config.Text(),
                    .path = args.config.Name(),
                    .overrides = args.config.Overrides(),
                    .ports = args.ports,
                    .engine = args.engine,
                    .console = &console,
                    .out = args.out,
                    .may_go_on = goes_on});
  before_serving.reset();
  interruptions.emplace(stop, console, [](int) {});
  ServeSocket socket(args.at, team);
  const Experiment& experiment = team.team().experiment();  // a client's reset may end its life
  ExplainCrashes();
  if (args.json)
    std::cout << R"({"address": ")" << socket.address() << "\"}\n";
  else
    console.Line(fmt::format("{}: {} agents wait to be stepped at {} (Ctrl-C ends)", experiment.run.name,
                             experiment.size(), socket.address()));
  if (!IsLoopback(args.at.address))
    console.Line("warning: whoever reaches this address can step the team, and give it events");
  FlushStandardOutput();
  const std::chrono::seconds patience(static_cast<int>(experiment.run.start_timeout_s) + 1);
  socket.Run(goes_on, args.once, patience);
  const bool has_ended = team.Leave();
  const int code = goes_on() ? kExitDone : 128 + interruptions->signal();
  if (!has_ended)  // threads use what would be destroyed
    LeaveNow({.code = code, .process = "orchestrator", .says_so = false});
  return code;
}

}  // namespace

std::function<int()> SetUpServe(CLI::App& command) {
  auto args = std::make_shared<ServeArgs>();
  args->config.AddTo(command);
  command
      .add_option_function<std::string>(
          "--at", [args](const std::string& address) { args->at = ReadLiveAddress(address, "--at"); },
          "where to listen (default: 127.0.0.1:8770; port 0: any free one)")
      ->type_name("ADDRESS:PORT");
  command.add_option("--ports", args->ports, "agents that take actions in the place of their laws: 1,2")
      ->delimiter(',')
      ->type_name("AGENTS");
  command.add_option("--engine", args->engine, "inprocess: in the server's process; dds: processes on a bus")
      ->check(OneOf({kInProcess, kOverDds}));
  command.add_option("--out", args->out, "record each episode as a run, in the folders DIR/1, DIR/2, ...")
      ->type_name("DIR");
  command.add_flag("--once", args->once, "end when the client that steps the team is gone");
  command.add_flag("--json", args->json, "print the address as JSON on stdout, and nothing else");
  command.footer("docs/serve.md has every request, and the bytes of the binary form.");
  return [args] { return Serve(*args); };
}

}  // namespace mascot
