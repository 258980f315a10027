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

/// The orchestrator's part on /status, /request and /experiment (the part of all other processes is bus/lifecycle.h),
/// and the recorder's voice there. What is said goes to a log.
class Hub {
 public:
  using Status = Roster::Status;

  /// `log` is the file of the log. `wake` is called, from any thread, when the loop should look.
  Hub(Domain& domain, const Experiment& experiment, const std::string& log, std::function<void()> wake);

  /// Hands the experiment out if somebody asked for it. Cheap to call often.
  void HandOutExperiment();
  /// The recorder is ready. Cheap to call often: it is repeated five times a second.
  void SayReady();
  /// The recorder has rows 0 .. rows - 1.
  void Confirm(std::int64_t rows);
  void Ask(mascot::Ask ask, const std::string& reason);
  /// Processes that listen to requests.
  int listeners() const { return requests_.matched(); }

  /// What a process said last, if it has said anything.
  std::optional<Status> StatusOf(const std::string& process) const;
  /// For whom the start still waits, in words.
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
  Reader<StatusType> status_;  // last: it calls what is above
};

}  // namespace mascot
