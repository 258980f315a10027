#pragma once

#include <string>

namespace mascot {

/// A request to a run while it goes on, or to the playback of a recording.
struct Request {
  enum class Kind { kPause, kResume, kStep, kPace, kStop, kEvent, kSeek, kStart, kLand, kKill };
  Kind kind = Kind::kPause;
  /// kLand, kKill: the agent whose vehicle is meant, 0: all; kStep: ticks; kPace: simulated seconds a second, 0: as
  /// fast as it goes; kSeek: time (s); kEvent, once it is checked: it must take effect before this tick.
  double number = 0;
  std::string toml = {};  ///< kEvent: the keys of one [[events]] table, without at_s
};

struct Answer {
  bool granted = false;
  std::string words = {};  ///< what will happen, or why not
  bool operator==(const Answer&) const = default;
};

/// Takes requests from any thread. Ask() returns with the answer, usually within a second or two.
class RunControl {
 public:
  virtual ~RunControl() = default;
  virtual Answer Ask(const Request& request) = 0;
};

}  // namespace mascot
