#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/dds/own_domain.h"
#include "orchestrator/engines/dds/replay_delivery.h"
#include "orchestrator/engines/dds/run_links.h"
#include "orchestrator/engines/dds/wire_audit.h"
#include "orchestrator/recording/decisions.h"
#include "orchestrator/recording/recorded_life.h"
#include "system/children.h"
#include "system/console.h"
#include "system/private_folder.h"
#include "system/stop_signal.h"

namespace mascot {

/// Lets the process of one agent, the real program, live through a recording, over DDS as in its run: it gets the
/// recorded states, messages, events and actions, tick by tick, and its answers are compared with those recorded. The
/// next tick comes once it has answered. For the agent, one participant stands for all other processes of the run.
///
/// An agent that was lost has no process until it starts afresh; then it is a fresh one, from that tick on.
class Player {
 public:
  /// How the agent's program is started.
  struct Program {
    /// A command line of the shell to which the agent's arguments are added: another agent program, which may need an
    /// emulator. Empty: the agent of this build.
    std::string command = {};
    /// Words in front of the program: a debugger, which has our terminal. Nothing is bounded in time then. Empty: none.
    std::vector<std::string> debugger = {};

    /// Whether the process that is started is the agent of this build itself.
    bool is_plain() const { return command.empty() && debugger.empty(); }
  };
  struct Result {
    std::string failure;      ///< why it has ended before the end of the recording; empty: it has not
    int signal = 0;           ///< that has ended it
    int processes = 0;        ///< how many the agent has had
    std::int64_t lost = 0;    ///< ticks at which it had none
    std::int64_t missed = 0;  ///< ticks that it has not answered in real time
  };

  /// `experiment` is what the agent's process gets: with one agent a process, all on this host. All arguments must
  /// outlive this object.
  Player(RecordedLife& life, const Experiment& experiment, int agent, Program program, Decisions& decisions,
         Console& console, StopSignal& stop);
  ~Player();  ///< calls End()
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;

  /// Plays until the end of what is recorded, a failure or a signal.
  Result Play();
  /// Ends the agent's process and leaves the domain. Returns whether the DDS library let go (OwnDomain::Leave).
  bool End();

 private:
  using Clock = std::chrono::steady_clock;

  void Join();
  /// Makes readers and writers for the newest process of the agent, in place of those for the one before.
  void Connect();
  void PlayTicks();
  void Begin(std::int64_t tick);
  void Lose(std::int64_t tick);
  void Spawn(std::int64_t tick);
  std::vector<std::string> ArgumentsOf(std::int64_t tick) const;
  void AwaitReady(std::int64_t tick);
  bool IsReady(std::int64_t tick) const;
  void PlayEvents(const Row& row);
  void PlayTick(const RecordedLife::Tick& tick);
  void Await(std::int64_t tick);
  /// Waits for whatever comes next, at most so long. Returns false once a signal has come. Throws std::runtime_error if
  /// the agent's process has ended, or the wire is not what it should be.
  bool Wait(std::chrono::nanoseconds timeout);
  void LookAtProcess();
  void AwaitDebugger();
  std::string At() const;
  DomainOptions Options() const;

  RecordedLife& life_;
  const Experiment& experiment_;
  const int agent_;
  const std::string process_;  // its name
  const Program program_;
  Decisions& decisions_;
  Console& console_;
  StopSignal& stop_;
  Result result_;
  std::int64_t tick_ = -1;   // the newest
  bool lives_ = false;       // the agent has a process
  bool hears_ = false;       // that process has been sent a tick
  bool said_first_ = false;  // the first difference is printed
  int number_ = 0;           // DomainOptions::number of the newest process

  const PrivateFolder logs_folder_;
  std::optional<OwnDomain> own_domain_;
  bool is_star_ = false;
  ChildLogs logs_;
  Children children_;
  ChildProcess debugger_;
  Peers peers_;
  WireAudit audit_;

  std::mutex mutex_;
  std::optional<ReplayDelivery::Answer> answer_;  // guarded by mutex_: the newest

  std::optional<Domain> domain_;
  std::optional<RunLinks> links_;
  std::optional<RawWriter> events_;
  std::optional<RawWriter> actions_;  // if the agent takes some
  std::unique_ptr<ReplayDelivery> delivery_;
  bool ended_ = false, let_go_ = true;
};

}  // namespace mascot
