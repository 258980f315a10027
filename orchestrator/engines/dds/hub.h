#pragma once

#include <spdlog/logger.h>

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "bus/bus.h"
#include "bus/wire.h"
#include "experiment/experiment.h"
#include "orchestrator/recording/run_folder.h"

namespace mascot {

/// The orchestrator's part on /status, /request and /experiment (the others' is bus/lifecycle.h), and the
/// recorder's voice there. What is said goes to logs/orchestrator.log.
class Hub {
 public:
  using Status = mascot_msgs::msg::Status;

  /// `wake` is called, from any thread, when the loop should look.
  Hub(Domain& domain, const Experiment& experiment, const RunFolder& folder, std::function<void()> wake);

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
  /// Who has not been heard of, in words.
  std::string Unheard() const;

 private:
  using WallClock = std::chrono::steady_clock;
  void OnStatus(const Status& status);

  const Experiment& experiment_;
  std::function<void()> wake_;
  spdlog::logger log_;
  mascot_msgs::msg::Experiment message_;
  WallClock::time_point next_hello_{}, next_hand_out_{};
  mutable std::mutex mutex_;  // guards what follows
  std::map<std::string, Status> statuses_;
  bool experiment_wanted_ = false;

  Writer<ExperimentType> experiments_;
  Writer<RequestType> requests_;
  Writer<StatusType> recorder_;
  Reader<StatusType> status_;  // last: it calls what is above
};

}  // namespace mascot
