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

/// Command line of a process that joins a run.
struct ProcessArgs {
  DomainOptions options;
  AgentRange agents;  ///< 0..0: not a process of agents
  int wait_s = 60;    ///< for an orchestrator to hand out the experiment
  int parent = 0;     ///< pid of the orchestrator that spawned this process and with which it ends; 0: by hand
  bool is_agent = false;

  explicit ProcessArgs(bool agent_process) : is_agent(agent_process) {}
  void AddTo(CLI::App& app);
};

/// What `main` of the physics server and of an agent have in common: parse, join the domain, await the
/// experiment, `run` (which never returns: it ends by an exception), report a failure to the run, print it,
/// clean up. Returns the exit code: 0 ended by the run, 1 failed, 2 usage, 130 / 143 by signal.
int ProcessMain(CLI::App& app, int argc, char** argv, ProcessArgs& args, StopSignal& stop,
                const std::function<void(Domain&, Lifecycle&, const mascot_msgs::msg::Experiment&)>& run);

}  // namespace mascot
