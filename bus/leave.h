#pragma once

#include <chrono>
#include <string>

namespace mascot {

/// How a process is ended that takes too long to end by itself.
struct Leaving {
  int code = 0;
  std::string process;      ///< its name
  bool on_signals = false;  ///< SIGINT, SIGTERM and SIGHUP also end the process by force; else it does not heed them
  bool says_so = true;      ///< the process prints that the DDS library does not end
  /// The process replaces itself by one that removes its shared memory (kSweep), because no other process does that.
  bool sweeps = false;
};

/// If the calling process has not ended after `limit`, it is ended by force, and a line on stderr says so. The main
/// thread calls this before it destroys DDS entities: that waits for threads of Fast DDS, and for laws in them, and
/// these may hang. A later call replaces an earlier one.
void LeaveWithin(std::chrono::seconds limit, const Leaving& leaving);

/// Ends the calling process by force, at once.
[[noreturn]] void LeaveNow(const Leaving& leaving);

}  // namespace mascot
