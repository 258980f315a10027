#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "base/agent_range.h"

namespace mascot {

/// The processes that have joined at the start of a run: this object knows which of them are ready, when to ask again,
/// and which are missing when the time is up. No clock: the caller passes in the time.
class JoinList {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class Next {
    kWait,
    kAsk,    ///< ask every process to publish its status again
    kStart,  ///< all are ready
    kFail,   ///< the time is up; Failure() says why
  };

  /// `start_timeout_s`: how long the processes may take to be ready. `has_vehicles`: the recorder is ready when people
  /// have let vehicles take off, which takes as long as it takes.
  JoinList(int agents, double start_timeout_s, bool has_vehicles = false);
  /// Notes that the process of these agents is ready, or not; the last call counts. Ids that do not exist are ignored.
  void OnAgents(AgentRange agents, bool ready);
  /// Notes that the recorder is ready, or not; the last call counts.
  void OnRecorder(bool ready);
  /// Starts the time limit.
  void Begin(Time now);
  /// What to do at `now`. `matched`: all readers and writers of the caller are matched.
  Next Look(Time now, bool matched);
  /// The failure for kFail: "not ready within run.start_timeout_s = 60.0 s: agents 2, 5 and the recorder".
  std::string Failure() const;

 private:
  /// What is missing: "agents 2, 5 and the recorder"; empty: nothing.
  std::string Missing() const;
  bool IsComplete() const;

  const double start_timeout_s_;
  const bool has_vehicles_;
  std::vector<bool> ready_;  // by id - 1
  bool recorder_ready_ = false;
  Time begun_;
  Time ask_again_;
};

}  // namespace mascot
