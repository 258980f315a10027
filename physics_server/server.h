#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "bus/lifecycle.h"
#include "experiment/experiment.h"
#include "physics_server/pace_meter.h"
#include "physics_server/progress_watch.h"
#include "physics_server/start_roll.h"
#include "physics_server/tick_barrier.h"
#include "physics_server/world.h"

namespace mascot {

/// The tick loop on the wire: publish every agent's state, gather every agent's command, step the world.
/// In lockstep the last command of a tick to arrive carries the world to the next, in the thread that
/// received it; in real time the calling thread paces the ticks and commands are held when late.
class Server {
 public:
  Server(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment);

  /// Waits until every endpoint is matched and every agent and the recorder are ready; runs all ticks;
  /// returns when the last command is gathered or a STOP came. Throws std::runtime_error naming who was
  /// late, or Ended.
  void Run();

 private:
  void AwaitEveryone();
  void BeginRollCall();
  /// Throws when the time is up.
  StartRoll::Next LookAtRoll();
  /// Every process says again how far it is, for those that did not hear it.
  void AskForReports();
  void Start();
  void RunLockstep();
  void RunRealtime();
  bool Matched() const;
  /// Until Finish(); throws if nothing moves for run.agent_timeout_s.
  void WatchProgress();
  bool Published(std::int64_t tick);
  /// Until tick is published; it waits for the recorder only.
  void AwaitRecorder(std::int64_t tick);
  void Report();

  void OnCommand(int id, const mascot_msgs::msg::AgentCommand& command);
  void OnStatus(const mascot_msgs::msg::Status& status);
  // All below with mutex_ held.
  void PublishIfRecorded();
  void Publish();
  /// What each agent may hear, of the states in samples_.
  void PublishBundles();
  void Advance();
  void Finish();
  bool AwaitsRecorder() const;
  std::chrono::nanoseconds RecorderGrace() const;
  /// Realtime, where commands are held: throws if one has been held for longer than run.agent_timeout_s.
  void CheckForDeadAgents(double period_s) const;
  std::runtime_error Overdue(std::int64_t tick) const;

  Lifecycle& lifecycle_;
  const Experiment& experiment_;
  const std::int64_t last_tick_;
  const bool realtime_;

  std::mutex mutex_;
  StartRoll roll_;
  World world_;
  ProgressWatch watch_;
  TickBarrier barrier_;
  std::vector<Actuation> commands_;         // by id - 1: what the world is stepped with
  std::vector<std::int64_t> command_tick_;  // the tick that each of them answered
  std::int64_t recorded_rows_ = 0;          // rows 0 .. recorded_rows_ - 1 are safe
  std::int64_t published_ = -1;             // newest tick published
  PaceMeter pace_;
  bool running_ = false;
  std::atomic<bool> done_ = false;

  std::vector<std::unique_ptr<Writer<StateType>>> states_;
  std::vector<int> state_readers_;                            // by id - 1: how many each must find
  std::vector<std::unique_ptr<Writer<BundleType>>> bundles_;  // none: states are delivered one by one
  std::vector<mascot_msgs::msg::AgentState> samples_;         // of the tick published last, by id - 1
  mascot_msgs::msg::AgentBundle bundle_;
  Writer<ClockType> clock_;
  Writer<RequestType> requests_;
  std::vector<std::unique_ptr<Reader<CommandType>>> command_readers_;
  Reader<StatusType> status_reader_;
};

}  // namespace mascot
