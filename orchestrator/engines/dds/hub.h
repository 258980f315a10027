#pragma once

#include <spdlog/logger.h>

#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "bus/bus.h"
#include "bus/wire.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/dds/roster.h"

namespace mascot {

/// The orchestrator's readers and writers on /status, /request and /experiment (bus/lifecycle.h has those of all other
/// processes). Also sends the recorder's status. Logs what is received and sent.
class Hub {
 public:
  using Status = Roster::Status;

  /// `log` is the path of the log file. `wake` is called, from any thread, when the loop should look without delay.
  Hub(Domain& domain, const Experiment& experiment, const std::string& log, std::function<void()> wake);

  /// Publishes the experiment if a process has asked for it. Cheap to call often.
  void HandOutExperiment();
  /// Publishes that the recorder is ready, at most five times a second. Cheap to call often.
  void SayReady();
  /// Publishes that rows 0 .. rows - 1 are recorded.
  void Confirm(std::int64_t rows);
  /// Publishes a request to all processes.
  void Ask(mascot::Ask ask, const std::string& reason);
  /// Number of processes that listen to requests.
  int listeners() const { return requests_.matched(); }

  /// The latest status of a process; nothing if there is none yet.
  std::optional<Status> StatusOf(const std::string& process) const;
  /// Whether every process has said that it has received the experiment of this run.
  bool HaveTheExperiment() const;
  /// What the start still waits for, as text for an error message.
  std::string Missing() const;

 private:
  void OnStatus(const Status& status);

  std::function<void()> wake_;
  spdlog::logger log_;
  mascot_msgs::msg::Experiment message_;
  mutable std::mutex mutex_;  // guards roster_
  Roster roster_;

  Writer<ExperimentType> experiments_;
  Writer<RequestType> requests_;
  Writer<StatusType> recorder_;
  Reader<StatusType> status_;  // last: its callback uses the members above
};

}  // namespace mascot
