#pragma once

#include <mascot.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mascot {

/// The latest status of every process of a run, as published on /status, and what the orchestrator does next.
///
/// Without DDS, clock, log or lock: RunLinks passes in the statuses and the time.
class ProcessTable {
 public:
  using Status = mascot_msgs::msg::Status;
  using Time = std::chrono::steady_clock::time_point;

  struct Rules {
    std::vector<std::string> processes;  ///< names of all processes, the physics server first
    /// By agent id - 1: the agent was started by hand, so that its exit is not seen.
    std::vector<bool> external;
    std::uint64_t experiment = 0;  ///< digest of the experiment of this run
    std::int64_t last_tick = 0;    ///< of the run
  };

  /// What a status changes.
  struct News {
    bool changed = false;  ///< the status is the first of its process, or its state differs from the last
    bool wake = false;     ///< the loop should look without delay
  };

  explicit ProcessTable(Rules rules);

  /// Takes a status of `process`. Throws std::runtime_error if an external agent reports that it has failed, if a
  /// process has received another experiment than that of this run, or if the status is impossible in this run.
  News OnStatus(const std::string& process, const Status& status);
  /// Acts as if a process had asked for the experiment.
  void WantExperiment() { experiment_wanted_ = true; }
  /// Whether to publish the experiment now: a process has asked for it since the last time, and that is at least 0.1 s
  /// ago. All processes receive it each time, so that a hundred agents that ask at once need it only once.
  bool IsTimeToHandOut(Time now);
  /// Whether to publish now that the recorder is ready: at most five times a second.
  bool IsTimeForHello(Time now);

  /// The latest status of a process; nothing if there is none yet.
  std::optional<Status> Of(const std::string& process) const;
  /// Whether every process has said that it has received the experiment of this run.
  bool HaveTheExperiment() const;
  /// What the start still waits for, as text for an error message.
  std::string Missing() const;

 private:
  const Rules rules_;
  std::map<std::string, Status> statuses_;
  bool experiment_wanted_ = false;
  Time next_hand_out_{}, next_hello_{};
};

}  // namespace mascot
