#pragma once

#include <atomic>
#include <chrono>

namespace mascot {

/// Whether this process ignores `signal`. A signal that nohup made this process ignore must not be blocked: blocked
/// signals are queued even if they are ignored.
bool IsIgnored(int signal);

/// Blocks SIGINT, SIGTERM, SIGUSR1, by which batch systems say that the time of a job is nearly up, SIGCHLD and, unless
/// it is ignored (nohup), SIGHUP, so that a loop can wait in one call for a signal, for a wake-up from another thread,
/// or for a timeout. No handlers, no globals. Make it first in main: libraries start threads, which must inherit the
/// blocked mask. If a law closes the descriptors of this object, the object opens new ones. Throws std::system_error.
class StopSignal {
 public:
  StopSignal() : StopSignal(Hears::kSignals) {}
  /// What a loop waits for: signals, too, or only what other threads say; then no signal is blocked, or unblocked.
  enum class Hears { kSignals, kThreads };
  explicit StopSignal(Hears hears);
  ~StopSignal();  ///< discards pending signals of these kinds and unblocks them
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Waits at most `timeout`. Returns one SIGINT, SIGTERM, SIGUSR1 or SIGHUP that came, or 0 after Wake(), the end of a
  /// child or the timeout.
  int Within(std::chrono::nanoseconds timeout);
  /// Makes the running Within(), or the next one, return. Thread-safe.
  void Wake();
  /// Makes it return this signal, as if that had come. Thread-safe.
  void Raise(int signal);

 private:
  void Open();

  const Hears hears_;
  std::atomic<int> raised_ = 0;    // Raise()
  std::atomic<int> signals_ = -1;  // signalfd
  std::atomic<int> wakeups_ = -1;  // eventfd
  std::atomic<bool> woken_ = false;
};

}  // namespace mascot
