#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <utility>

namespace mascot {

/// Sends a signal to a process. Not to one that was never started, or has been reaped: to kill(2), process 0 is all of
/// our process group, -1 everybody, and a number that was reaped may be somebody else's by now.
void SignalProcess(pid_t process, int signal);

/// In place of a status from waitpid: how the process ended cannot be told, because somebody else has reaped it.
inline constexpr int kUnknownEnd = -1;

/// "exited with code 3", "was killed by signal 11 (Segmentation fault)", of a status from waitpid.
std::string EndText(int status);

/// Owns a child process, or none. Nobody else reaps it, and its number is forgotten when it is reaped: so a signal can
/// reach no other process that got the same number later.
class ChildProcess {
 public:
  ChildProcess() = default;
  /// `number`: of a process that this one has just started.
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
  /// Waits until the process has ended, and reaps it. Returns likewise.
  std::optional<int> Reap() { return Reap(/*wait=*/true); }
  /// Leaves the process to itself: it is neither killed nor reaped.
  void Release() { number_ = 0; }

 private:
  std::optional<int> Reap(bool wait);

  pid_t number_ = 0;
};

}  // namespace mascot
