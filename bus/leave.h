#pragma once

#include <chrono>
#include <exception>
#include <string>

namespace mascot {

/// How a process ends that takes too long to end by itself.
struct Leaving {
  int code = 0;
  std::string process;      ///< its name
  bool on_signals = false;  ///< SIGINT, SIGTERM and SIGHUP, too, end it by force
  bool says_so = true;      ///< it prints that the DDS library does not end
  bool sweeps = false;      ///< it replaces itself by a process that sweeps (kSweep), since nobody else does
};

/// From now on the calling process leaves: after `limit` it ends by force, and says so in a line on stderr. To be
/// called by the main thread before it destroys DDS entities: that waits for threads of Fast DDS and, in them, of laws,
/// and these may hang. A later call replaces an earlier one.
void LeaveWithin(std::chrono::seconds limit, const Leaving& leaving);

/// Leaves by force at once.
[[noreturn]] void LeaveNow(const Leaving& leaving);

/// Makes an exception that nobody catches, in a thread of Fast DDS, say, an error in words and exit code 1 (the default
/// is SIGABRT). Also explains SIGBUS, by which a full /dev/shm ends a process.
void SayWhatIsUncaught();

/// What went wrong, in words: what() of most exceptions; one that is thrown for want of memory or threads says so.
std::string InWords(const std::exception& failure);

}  // namespace mascot
