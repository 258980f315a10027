#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>

#include "bus/bus.h"
#include "bus/stop_signal.h"
#include "bus/wire.h"
#include "experiment/contacts.h"
#include "experiment/pacing.h"

namespace mascot {

/// How a loop that waits was ended from outside, in an orderly way.
class Ended : public std::exception {
 public:
  explicit Ended(int signal) : signal_(signal) {}
  int signal() const { return signal_; }  ///< 0: the run asked this process to end
  const char* what() const noexcept override { return "ended from outside"; }

 private:
  int signal_;
};

/// The part that every process of a run but the orchestrator plays on /status, /request and /experiment:
/// it says what it is doing, says it again when asked, and ends when asked. Nothing here relies on a match
/// event or a single delivery: who lacks something keeps asking.
class Lifecycle {
 public:
  /// `agent`: 0 where the process has none, or several.
  Lifecycle(Domain& domain, StopSignal& stop, std::string process, int agent);

  /// Asks for the experiment until it comes. Throws std::runtime_error after `timeout`, naming what was
  /// missing; throws Ended as Wait does.
  mascot_msgs::msg::Experiment AwaitExperiment(std::chrono::seconds timeout);
  /// Publishes a new state.
  void Set(Life life, const std::string& reason = {});
  /// Publishes the last state of a process that leaves, and waits until everybody has it, at most 3 s: where a process
  /// was killed while it held a lock of shared memory, the others get past it after 2 s.
  void Part(Life life, const std::string& reason = {});
  /// Publishes the counters with the state as it is. Any thread.
  void Report(std::uint64_t tick, const Pacing& pacing, const Contacts& contacts);
  /// Waits for a wake-up, at most `timeout`. Throws Ended when a signal or an END came, and whatever a
  /// callback of the domain threw; throws std::runtime_error when the orchestrator has left the domain. From then on
  /// the process has 5 s to leave, too, before SIGALRM.
  void Wait(std::chrono::nanoseconds timeout);
  /// Ends a Wait of the loop's thread. Any thread.
  void Wake() { stop_.Wake(); }
  /// A STOP was requested.
  bool stop_requested() const { return stop_requested_; }

 private:
  void OnRequest(const mascot_msgs::msg::Request& request);
  void Publish();

  StopSignal& stop_;
  Domain& domain_;
  std::mutex mutex_;  // guards status_ and experiment_
  mascot_msgs::msg::Status status_;
  std::optional<mascot_msgs::msg::Experiment> experiment_;
  std::atomic<bool> stop_requested_ = false;
  std::atomic<bool> end_requested_ = false;
  std::atomic<bool> report_requested_ = false;
  bool joined_ = false;  // the orchestrator was here once
  Writer<StatusType> status_writer_;
  Reader<ExperimentType> experiment_reader_;
  Reader<RequestType> request_reader_;
};

}  // namespace mascot
