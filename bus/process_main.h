#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "bus/bus.h"
#include "bus/lifecycle.h"
#include "experiment/toml/section.h"
#include "system/stop_signal.h"

namespace CLI {
class App;
}

namespace mascot {

/// Command-line options of a process that joins a run.
struct ProcessArgs {
  DomainOptions options;
  AgentRange agents;  ///< the agents of this process, or the one of this vehicle; 0..0: none (the physics server)
  int wait_s = 60;    ///< how long to wait for the experiment
  int awaited = 0;    ///< how many participants to discover before readers and writers are made (Domain::AwaitOthers)
  /// Pid of the process that started this one, which ends with it; 0: this one was started by hand.
  int parent = 0;
  std::int64_t from_tick = 0;  ///< the first tick to answer: 0, or that of a restart
  int orchestrator = 0;        ///< pid of the orchestrator, if that is not the parent but on another host
  enum class Kind { kServer, kAgents, kVehicle } kind = Kind::kServer;
  bool no_code = false;          ///< laws of users are refused
  std::string credentials_file;  ///< empty: the run has no network.security
  /// Where processes that start together take turns at authenticating themselves; empty: this one starts alone.
  std::filesystem::path turns;

  /// Whether somebody has started this agent by hand.
  bool IsByHand() const { return is_agent() && parent == 0 && orchestrator == 0; }
  bool is_agent() const { return kind == Kind::kAgents; }
  explicit ProcessArgs(Kind process) : kind(process) {}
  void AddTo(CLI::App& app);
};

/// What a process is in a run, once it has the experiment. Owns the process's endpoints of per-tick topics.
class Role {
 public:
  virtual ~Role() = default;
  /// Returns only by an exception, such as Ended or KilledByEvent.
  [[noreturn]] virtual void Run() = 0;
};
using RoleFactory = std::function<std::unique_ptr<Role>(Domain&, Lifecycle&, const mascot_msgs::msg::Experiment&)>;

/// The common `main` of the physics server, the agents and the vehicles: parses the command line, joins the domain,
/// waits for the experiment, runs the role that `make_role` makes, publishes and prints a failure, and leaves, by force
/// if the DDS library does not end within 5 s. Returns the exit code: 0 ended by the run, 1 failed, 2 wrong usage, 128
/// + signal (130, 143) ended by a signal. After KilledByEvent, SIGKILL ends the process instead.
int ProcessMain(CLI::App& app, int argc, char** argv, ProcessArgs& args, StopSignal& stop,
                const RoleFactory& make_role);

// If the first argument of a program is one of these, ProcessMain does this instead; the second argument is a number.
/// Removes segments of shared memory that dead processes left. The number is the exit code.
inline constexpr const char* kSweep = "--sweep-shared-memory";
/// Waits until stdin ends, then kills the processes that bear the mark of the run (MarkDescendants()), and removes the
/// run's shared memory. The number is the run's domain, whose lock the caller holds (Janitor), or kNoDomain. Standard
/// input holds nothing, or the name of a file, a zero byte, and the contents that the file gets if it does not exist by
/// then.
inline constexpr const char* kSweepAfterRun = "--sweep-after-run";

}  // namespace mascot
