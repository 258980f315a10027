#pragma once

#include <mascot.h>

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace mascot {

/// What the processes of a run have said of themselves on /status, and what follows from it.
///
/// It has no wire, clock, log or lock: Hub brings what was said, and says what time it is.
class Roster {
 public:
  using Status = mascot_msgs::msg::Status;
  using Time = std::chrono::steady_clock::time_point;

  struct Rules {
    std::vector<std::string> processes;  ///< that take part, the physics server first
    std::vector<bool> external;          ///< by agent id - 1: is started by hand, so that nobody sees its process end
  };

  /// What a status means for those who wait.
  struct News {
    bool changed = false;  ///< the process is heard for the first time, or is in another state
    bool wake = false;     ///< the loop should look without delay
  };

  explicit Roster(Rules rules);

  /// A process says how far it is. Throws std::runtime_error if it is an agent that was started by hand and has failed.
  News OnStatus(const Status& status);
  /// Whether to hand out the experiment now: somebody has asked for it since the last time, which is a while ago.
  /// Everybody hears it each time: it is not handed out once for each of a hundred agents that ask at once.
  bool IsTimeToHandOut(Time now);
  /// Whether to say now that the recorder is ready: five times a second.
  bool IsTimeForHello(Time now);

  /// What a process said last, if it has said anything.
  std::optional<Status> Of(const std::string& process) const;
  /// For whom the start still waits, in words.
  std::string Missing() const;

 private:
  const Rules rules_;
  std::map<std::string, Status> statuses_;
  bool experiment_wanted_ = false;
  Time next_hand_out_{}, next_hello_{};
};

}  // namespace mascot
