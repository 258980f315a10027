#include "bus/process_main.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <iostream>
#include <stdexcept>
#include <string_view>

#include "bus/shared_memory.h"
#include "bus/usage.h"
#include "experiment/experiment.h"

namespace mascot {
namespace {

using Run = std::function<void(Domain&, Lifecycle&, const mascot_msgs::msg::Experiment&)>;

constexpr const char* kSweep = "--sweep-shared-memory";

/// "3" or "1-50".
AgentRange ParseIds(const std::string& text) {
  const auto dash = text.find('-');
  const std::string name = (dash == text.npos ? "agent_" : "agents_") + text;
  const auto agents = AgentsOf(name);
  if (!agents || agents->first < 1 || agents->last > kMaxAgents)
    throw CLI::ValidationError("--id", "expected a number, or two such as 1-50, in 1 to " + std::to_string(kMaxAgents) +
                                           ", got '" + text + "'");
  return *agents;
}

/// Removes the shared memory of an orchestrator that was killed, or of this process if it cannot leave the domain. Fast
/// DDS still maps the segments that this process has read, and another child that sweeps would take those to be in use;
/// so this process replaces itself (exec) by a fresh one that sweeps. Closing all files releases its own locks.
/// Async-signal-safe.
void RestartToSweep() {
  ::close_range(STDERR_FILENO + 1, ~0U, 0);
  ::execl("/proc/self/exe", "sweep", kSweep, nullptr);
}

/// Joins the domain and calls `run`. Publishes a failure before it leaves. Returns the exit code.
int Join(const ProcessArgs& args, StopSignal& stop, const Run& run) {
  Domain domain(args.options, [&stop] { stop.Wake(); });
  Lifecycle lifecycle(domain, stop, args.options.name, args.agents.size() == 1 ? args.agents.first : 0);
  try {
    run(domain, lifecycle, lifecycle.AwaitExperiment(std::chrono::seconds(args.wait_s)));
    return 0;
  } catch (const Ended& ended) {
    return ended.signal() == 0 ? 0 : 128 + ended.signal();
  } catch (const std::exception& failure) {
    std::cerr << "error: " << failure.what() << std::endl;
    lifecycle.SetFinal(Life::kFailed, failure.what());
    return 1;
  }
}

}  // namespace

void ProcessArgs::AddTo(CLI::App& app) {
  if (is_agent)
    app.add_option_function<std::string>(
           "--id", [this](const std::string& text) { agents = ParseIds(text); },
           "This agent's number, 1..N, or those of all agents that share this process: 1-50")
        ->required();
  app.add_option("--domain", options.domain, "DDS domain of the run; `orchestrator up` prints it")
      ->required()
      ->check(CLI::Range(0, 232));
  app.add_option("--discovery", options.server, "IP-ADDRESS:PORT of the run's discovery server, if it has one");
  app.add_option("--transport", options.transport, "auto (shared memory on one host, UDP between hosts), udp or shm");
  app.add_option("--wait-s", wait_s, "How long to wait for an orchestrator")->check(CLI::Range(1, 86400));
  app.add_flag("--loopback", options.loopback, "Use only 127.0.0.1: everything runs on this host");
  app.add_option("--participants", options.participants, "How many processes this one talks to, about; sizes buffers")
      ->check(CLI::Range(1, 20000));
  app.add_option("--parent", parent, "Process id of the orchestrator that spawned this process: end when it dies");
}

int ProcessMain(CLI::App& app, int argc, char** argv, ProcessArgs& args, StopSignal& stop, const Run& run) {
  if (argc == 2 && std::string_view(argv[1]) == kSweep) {
    SweepSharedMemory();
    return 0;
  }
  args.AddTo(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << UsageText(app, error) << std::endl;
    return 2;
  }
  std::signal(SIGPIPE, SIG_IGN);                        // clean up even if stderr is the pipe of a dead orchestrator
  std::signal(SIGALRM, [](int) { RestartToSweep(); });  // Lifecycle::Wait(): could not leave
  if (args.parent != 0) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != args.parent) return 1;  // the orchestrator died before this line
  }
  args.options.name = args.is_agent ? ProcessName(args.agents) : "physics_server";
  if (!args.options.server.empty()) args.options.role = DiscoveryRole::kClient;
  int code = 1;
  try {
    code = Join(args, stop, run);
  } catch (const std::invalid_argument& usage) {
    std::cerr << "error: " << usage.what() << std::endl;
    code = 2;
  } catch (const std::exception& failure) {
    std::cerr << "error: " << failure.what() << std::endl;
  }
  if (args.parent != 0 && getppid() != args.parent) RestartToSweep();
  return code;
}

}  // namespace mascot
