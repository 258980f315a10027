#pragma once

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "bus/stop_signal.h"
#include "orchestrator/processes/console.h"

namespace mascot {

/// Listens for signals beside a thread that a law may hold up: the first asks it to stop, the second ends the process,
/// with a recording that is cut.
class Interruptions {
 public:
  Interruptions(StopSignal& stop, Console& console)
      : stop_(stop), console_(console), thread_([this](const std::stop_token& over) { Listen(over); }) {}
  ~Interruptions() {
    thread_.request_stop();
    stop_.Wake();
  }
  Interruptions(const Interruptions&) = delete;
  Interruptions& operator=(const Interruptions&) = delete;

  /// The signal that asked to stop; 0: none so far.
  int signal() const { return signal_; }

 private:
  void Listen(const std::stop_token& over) {
    while (!over.stop_requested()) {
      const int signal = stop_.Within(std::chrono::hours(1));
      if (signal == 0) continue;
      if (signal_ != 0) _exit(128 + signal);  // no destructors: they would wait for what does not end
      signal_ = signal;
      console_.Line("stopping (once more to kill)");
    }
  }

  StopSignal& stop_;
  Console& console_;
  std::atomic<int> signal_ = 0;
  std::jthread thread_;
};

}  // namespace mascot
