#pragma once

#include <signal.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <thread>
#include <utility>

#include "system/console.h"
#include "system/descendants.h"
#include "system/end_now.h"
#include "system/stop_signal.h"

namespace mascot {

/// Receives signals in a thread of its own, because a slow law may block the thread of the run. The first signal asks
/// the run to stop; the second ends the process at once, which leaves the recording without its end.
class Interruptions {
 public:
  /// `before_kill` is called with the exit code right before the second signal ends the process.
  Interruptions(StopSignal& stop, Console& console, std::function<void(int code)> before_kill)
      : stop_(stop),
        console_(console),
        before_kill_(std::move(before_kill)),
        thread_([this](const std::stop_token& over) { Listen(over); }) {}
  ~Interruptions() {
    thread_.request_stop();
    stop_.Wake();
  }
  Interruptions(const Interruptions&) = delete;
  Interruptions& operator=(const Interruptions&) = delete;

  /// The first signal received; 0: none so far.
  int signal() const { return signal_; }

 private:
  void Listen(const std::stop_token& over) {
    while (!over.stop_requested()) {
      const int signal = stop_.Within(std::chrono::hours(1));
      if (signal == 0) continue;
      if (signal_ != 0) {
        before_kill_(128 + signal);
        EndNow(128 + signal);  // without destructors, which would wait for the blocked thread
      }
      signal_ = signal;
      console_.Line("stopping (once more to kill)");
    }
  }

  StopSignal& stop_;
  Console& console_;
  const std::function<void(int)> before_kill_;
  std::atomic<int> signal_ = 0;
  std::jthread thread_;
};

/// While this object lives, a signal ends the process at once, with exit code 128 + signal, in whatever its main thread
/// hangs. For the time in which nothing has begun that would have to be ended in order.
class EndsAtOnce {
 public:
  explicit EndsAtOnce(StopSignal& stop) : stop_(stop), thread_([this](const std::stop_token& over) { Listen(over); }) {}
  ~EndsAtOnce() {
    thread_.request_stop();
    stop_.Wake();
  }
  EndsAtOnce(const EndsAtOnce&) = delete;
  EndsAtOnce& operator=(const EndsAtOnce&) = delete;

 private:
  void Listen(const std::stop_token& over) const {
    while (!over.stop_requested()) {
      const int signal = stop_.Within(std::chrono::hours(1));
      if (signal == 0) continue;
      KillDescendants();  // what laws have started
      EndNow(128 + signal);
    }
  }

  StopSignal& stop_;
  std::jthread thread_;
};

}  // namespace mascot
