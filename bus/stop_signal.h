#pragma once

#include <chrono>

namespace mascot {

/// Takes SIGINT, SIGTERM, SIGHUP and SIGCHLD out of the ordinary way of signals, so that loops can wait for
/// them, for a wake-up from another thread, and for time, in one call. No handlers, no globals.
/// Make it first in main: libraries start threads, which must inherit the blocked mask.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();  ///< restores the mask
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Waits at most `timeout`. Returns the signal that asks to stop (one a call), or 0 after Wake(), the end of a child
  /// or the timeout.
  int Within(std::chrono::nanoseconds timeout);
  /// Ends a Within() of another thread, or the next one. Any thread may call it.
  void Wake();

 private:
  int signals_;  // signalfd
  int wakeups_;  // eventfd
};

}  // namespace mascot
