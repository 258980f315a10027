#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "bus/bus.h"
#include "bus/lifecycle.h"
#include "bus/stop_signal.h"
#include "experiment/toml/section.h"

namespace CLI {
class App;
}

namespace mascot {

/// Command-line options of a process that joins a run.
struct ProcessArgs {
  DomainOptions options;
  AgentRange agents;  ///< 0..0: none (the physics server)
  int wait_s = 60;    ///< how long to wait for the experiment
  int parent = 0;     ///< pid of the orchestrator that spawned this process: ends with it; 0: started by hand
  bool is_agent = false;

  explicit ProcessArgs(bool agent_process) : is_agent(agent_process) {}
  void AddTo(CLI::App& app);
};

/// The common `main` of the physics server and the agents: parses the command line, joins the domain, waits for the
/// experiment, calls `run` (which does not return normally: it ends by an exception, such as Ended), publishes and
/// prints a failure, cleans up. With --sweep-shared-memory as the only argument it just calls SweepSharedMemory().
/// Returns the exit code: 0 ended by the run, 1 failed, 2 wrong usage, 128 + signal (130, 143) ended by a signal.
int ProcessMain(CLI::App& app, int argc, char** argv, ProcessArgs& args, StopSignal& stop,
                const std::function<void(Domain&, Lifecycle&, const mascot_msgs::msg::Experiment&)>& run);

}  // namespace mascot
