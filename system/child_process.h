#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <utility>

namespace mascot {

/// Sends a signal to a process; does nothing if `process` is not positive, because kill(2) takes 0 for all of our
/// process group and -1 for every process. The process must not have been reaped: another one may have its number by
/// now.
void SignalProcess(pid_t process, int signal);

/// In place of a status from waitpid: how the process ended cannot be told, because other code has reaped it.
inline constexpr int kUnknownEnd = -1;

/// "exited with code 3", "was killed by signal 11 (Segmentation fault)", for a status from waitpid or kUnknownEnd.
std::string EndText(int status);

/// Owns a child process, or none. No other code reaps the process, and this object forgets its number when it reaps it:
/// so a signal can reach no other process that got the same number later.
class ChildProcess {
 public:
  ChildProcess() = default;
  /// `number`: the id of a process that this process has just started.
  explicit ChildProcess(pid_t number) : number_(number) {}
  ~ChildProcess();  ///< kills and reaps
  ChildProcess(ChildProcess&& other) noexcept : number_(std::exchange(other.number_, 0)) {}
  ChildProcess& operator=(ChildProcess&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }

  /// The process id; 0: there is no process, or it has been reaped.
  pid_t number() const { return number_; }
  /// Sends a signal, if there is a process.
  void Signal(int signal) const { SignalProcess(number_, signal); }
  /// Reaps the process if it has ended. Returns its status from waitpid, or kUnknownEnd; nothing: it still runs, or
  /// there is none.
  std::optional<int> ReapIfEnded() { return Reap(/*wait=*/false); }
  /// Waits until the process has ended, and reaps it. Returns its status from waitpid, or kUnknownEnd; nothing: there
  /// is none.
  std::optional<int> Reap() { return Reap(/*wait=*/true); }
  /// Leaves the process to itself: it is neither killed nor reaped.
  void Release() { number_ = 0; }

 private:
  std::optional<int> Reap(bool wait);

  pid_t number_ = 0;
};

}  // namespace mascot
