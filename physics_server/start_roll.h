#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "experiment/agent_range.h"

namespace mascot {

/// The roll call before a run: who is ready, when to ask again, who was missing when the time was up. No clock: it is
/// told the time.
class StartRoll {
 public:
  using Time = std::chrono::steady_clock::time_point;
  enum class Next {
    kWait,
    kAsk,    ///< everybody must be asked to say again how far they are
    kStart,  ///< everybody is ready
    kFail,   ///< the time is up, for the reason Failure()
  };

  /// `start_timeout_s` is how long a call may take.
  StartRoll(int agents, double start_timeout_s);
  /// These agents' process said whether it is ready; what it said last counts. Agents that there are not are ignored.
  void OnAgents(AgentRange agents, bool ready);
  /// The recorder said so.
  void OnRecorder(bool ready);
  /// The call, and its time, begin.
  void Begin(Time now);
  /// `matched`: the readers and writers of whoever calls have found all of theirs.
  Next Look(Time now, bool matched);
  /// "not ready within run.start_timeout_s = 60.0 s: agents 2, 5 and the recorder".
  std::string Failure() const;

 private:
  /// "agents 2, 5 and the recorder"; empty: nobody.
  std::string Missing() const;
  bool IsComplete() const;

  const double start_timeout_s_;
  std::vector<bool> ready_;  // by id - 1
  bool recorder_ready_ = false;
  Time begun_;
  Time ask_again_;
};

}  // namespace mascot
