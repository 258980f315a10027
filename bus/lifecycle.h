#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/contacts.h"
#include "base/pacing.h"
#include "bus/bus.h"
#include "bus/wire.h"
#include "system/stop_signal.h"

namespace mascot {

/// Thrown by Lifecycle::Wait() when a signal or an END request ends this process in an orderly way.
class Ended : public std::exception {
 public:
  explicit Ended(int signal) : signal_(signal) {}
  int signal() const { return signal_; }  ///< 0: an END request
  const char* what() const noexcept override { return "ended from outside"; }

 private:
  int signal_;
};

/// Thrown to end this process because an event of the run kills its agents. The process leaves the domain before it
/// dies: see SayFarewellFor().
class KilledByEvent : public std::exception {
 public:
  const char* what() const noexcept override { return "killed by an event of the run"; }
};

/// How far a run has come, as the physics server reports it.
struct RunProgress {
  std::int64_t tick = 0;          ///< the newest tick that is published
  std::uint32_t request = 0;      ///< number of the newest request carried out; 0: none yet
  std::int64_t request_tick = 0;  ///< the first tick for which this request holds; kOver or kTooLate: there is none
  bool paused = false;
  double pace = 0;                ///< simulated seconds per second; 0: as fast as the machine can
  int events = 0;                 ///< how many have taken effect
  std::vector<int> awaited = {};  ///< agents whose fresh processes the next tick waits for
};

/// The message of a process that has waited so long for an experiment.
std::string NoExperiment(std::chrono::seconds timeout);

/// The life cycle of a process of a run (the server or agents; the orchestrator has none). It publishes the state of
/// the process on /status, and again on a REPORT request; receives the experiment on /experiment; ends the process on
/// an END request or a signal. Nothing relies on a match event or a single delivery: a process that lacks something
/// keeps asking. A process obeys only the orchestrator; the physics server may ask it for reports.
class Lifecycle {
 public:
  /// `process` is the name of the process (ProcessName), `agent` the number of its agent, or 0 if it has none or
  /// several. `peers`, which must be that of `domain`, learns from the orchestrator which participants are the
  /// processes of the run.
  Lifecycle(Domain& domain, Peers& peers, StopSignal& stop, const std::string& process, int agent);

  /// Publishes WAITING every 0.2 s, and as soon as somebody listens, until the experiment comes, for processes that
  /// start at `from_tick`. Throws std::runtime_error after `timeout`, and what Wait() throws.
  mascot_msgs::msg::Experiment AwaitExperiment(std::chrono::seconds timeout, std::int64_t from_tick = 0);
  /// Publishes a new state. Thread-safe.
  void Set(Life life, const std::string& reason = {});
  /// Publishes the last state before this process ends, and waits until all readers have acknowledged it, at most 3 s:
  /// Fast DDS needs 2 s to get past a shared-memory lock that a killed process held.
  void SetFinal(Life life, const std::string& reason = {});
  /// Publishes new counters with the current state. Thread-safe.
  void Report(std::uint64_t tick, const Pacing& pacing, const Contacts& contacts);
  /// Publishes how far the run has come, with the current state. Thread-safe.
  void Report(const RunProgress& progress);
  /// Waits for a wake-up, at most `timeout`. Throws Ended after a signal or an END request, and std::runtime_error when
  /// the orchestrator has left the domain. Rethrows what a callback of the domain threw.
  void Wait(std::chrono::nanoseconds timeout);
  /// Makes the running Wait(), or the next one, return. Thread-safe.
  void Wake() { stop_.Wake(); }
  /// True after a STOP request.
  bool stop_requested() const { return stop_requested_; }

 private:
  void OnExperiment(const mascot_msgs::msg::Experiment& experiment);
  void OnRequest(const mascot_msgs::msg::Request& request, const std::string& from);
  void Publish();

  StopSignal& stop_;
  Domain& domain_;
  Peers& peers_;
  std::mutex mutex_;  // guards status_ and experiment_
  mascot_msgs::msg::Status status_;
  std::optional<mascot_msgs::msg::Experiment> experiment_;
  std::atomic<bool> stop_requested_ = false;
  std::atomic<bool> end_requested_ = false;
  std::atomic<bool> report_requested_ = false;
  bool orchestrator_seen_ = false;  // it has been in the domain
  Writer<StatusType> status_writer_;
  Reader<ExperimentType> experiment_reader_;
  Reader<RequestType> request_reader_;
};

}  // namespace mascot
