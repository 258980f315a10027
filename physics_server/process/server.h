#pragma once

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "bus/lifecycle.h"
#include "experiment/live_experiment.h"
#include "physics_server/process/delivery.h"
#include "physics_server/process/join_list.h"
#include "physics_server/process/pace_meter.h"
#include "physics_server/process/tick_protocol.h"
#include "physics_server/world.h"

namespace mascot {

/// The tick loop over DDS: it publishes every agent's state (Delivery), gathers every agent's command, and steps the
/// world. In lockstep, the reception thread that receives a tick's last command steps the world. In real time the
/// thread that calls Run() paces the ticks, and a late agent's last command is held. JoinList and TickProtocol decide
/// what to do when; Server does it.
class Server {
 public:
  Server(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment);

  /// Waits until every endpoint is matched and every agent and the recorder are ready; runs all ticks; returns when the
  /// last tick is answered or a STOP request has taken effect. Throws std::runtime_error naming the late agents or the
  /// recorder, and what Lifecycle::Wait() throws.
  void Run();

 private:
  void AwaitEveryone();
  void BeginJoining();
  /// Throws std::runtime_error if run.start_timeout_s is over.
  JoinList::Next LookAtJoinList();
  /// Asks every process to publish its status again, in case it was missed.
  void AskForReports();
  bool Matched() const;
  void RunTicks();
  void Start();
  /// Does what is due now. Throws std::runtime_error that names the late agents or the recorder.
  TickProtocol::Turn Look();
  void Report();
  /// Publishes how far the run has come: the answer to a request, and, while the gate holds a tick, a sign of life.
  void ReportProgress();

  void OnAnswers(std::span<const Delivery::Answer> answers);
  void OnMeasured(int id, const mascot_msgs::msg::AgentState& state);
  void OnStatus(const mascot_msgs::msg::Status& status, const std::string& from);
  /// Carries out what people ask of the ticks. The orchestrator repeats a request until it is answered.
  void OnRequest(const mascot_msgs::msg::Request& request);
  // The functions below are called with mutex_ held.
  void Do(const TickProtocol::Actions& actions);
  /// Steps the world; vehicles are where they have been measured.
  void Step();
  void Publish();
  /// Agents that do not answer the world's tick, as the file's events of the next one say, are not waited for.
  void LoseUnanswered();
  /// Holds the next tick if events of it restart agents whose processes must be fresh.
  void LookForRestarts();
  /// The agents that events restart at the next tick.
  std::vector<int> RestartsAhead() const;
  /// Carries out a new request. Returns the first tick for which it holds, or why there is none (kOver, kTooLate).
  std::int64_t CarryOut(const mascot_msgs::msg::Request& request);
  /// Publishes the events that take effect at the world's tick: those of the file, then those by hand.
  void PublishEvents();
  void TakeEvent(const Event& event);
  void PublishEvent(const Event& event, int number);
  /// Agents are lost, for real: the event that says so comes at the next tick. Throws std::runtime_error at the last.
  void Lose(std::span<const int> agents, FaultKind kind);
  /// Notes the age of the commands with which the world is stepped.
  void MeasureCommands();
  // The one below takes mutex_ itself.
  /// Lets the next tick happen if it was held for fresh processes, and all have joined. Throws std::runtime_error if
  /// run.start_timeout_s is over.
  void AwaitRestarts();

  Lifecycle& lifecycle_;
  const Experiment& experiment_;

  std::mutex mutex_;  // guards what is below except the endpoints
  JoinList join_list_;
  TickProtocol ticks_;
  World world_;
  LiveExperiment live_;
  std::size_t next_event_ = 0;  // in experiment_.events
  std::vector<Event> by_hand_;  // events of the next tick to be published
  /// Fresh processes for which the next tick waits.
  struct Restart {
    std::vector<AgentRange> processes = {}, ready = {};
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now(), ask_again = since;
  };
  std::optional<Restart> restart_;
  RunProgress progress_;
  std::atomic<bool> progress_is_new_ = true;  // others have not been told
  std::vector<Actuation> commands_;           // by id - 1: the commands with which the world is stepped
  std::map<int, Motion> measured_;            // of vehicles, by id: the newest
  PaceMeter pace_;

  Writer<EventType> events_;
  int event_readers_;  // how many events_ must match
  Writer<RequestType> requests_;
  std::unique_ptr<Delivery> delivery_;
  Reader<StatusType> status_reader_;
  Reader<RequestType> request_reader_;
  std::vector<std::unique_ptr<Reader<StateType>>> measured_readers_;  // of vehicles
};

}  // namespace mascot
