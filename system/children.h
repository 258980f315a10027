#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "system/child_logs.h"
#include "system/child_process.h"

namespace mascot {

/// Folder of the executable of this process.
std::filesystem::path ProgramFolder();

/// How a child ended.
struct Exit {
  std::string process;
  int status = 0;  ///< status from waitpid, or kUnknownEnd
  /// Exit code; nothing if a signal killed the child.
  std::optional<int> code() const;
  /// "exited with code 3", "was killed by signal 11 (Segmentation fault)"
  std::string Text() const { return EndText(status); }
};

/// Child processes of a run. Each has its own process group, so that Ctrl-C reaches only the orchestrator, and default
/// signal dispositions. No child outlives this object.
class Children {
 public:
  explicit Children(ChildLogs& logs) : logs_(logs) {}
  /// Children that are spawned from now on inherit this descriptor, under the same number.
  void Share(int descriptor) { shared_.push_back(descriptor); }
  ~Children();  ///< kills and reaps what is left
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;

  /// Starts `program` (a path, or a name in PATH) with `arguments`; messages call it `process`, and its output goes to
  /// the file `log`. Returns its process id. Throws std::runtime_error if it cannot be started.
  pid_t Spawn(const std::string& process, const std::string& program, const std::vector<std::string>& arguments,
              const std::filesystem::path& log) {
    return Spawn(process, program, arguments, log, {});
  }
  /// Descriptors for a child's standard input and output; -1: the input is /dev/null, the output goes to the log.
  struct Streams {
    int input = -1, output = -1;
  };
  pid_t Spawn(const std::string& process, const std::string& program, const std::vector<std::string>& arguments,
              const std::filesystem::path& log, const Streams& streams);
  /// A child of SpawnCopies().
  struct CopyOf {
    std::string process;
    std::vector<std::string> arguments;
    std::filesystem::path log;
  };
  /// How long to wait until copies are made: `limit_s`, and as long as `go_on` returns true.
  struct Patience {
    double limit_s = 0;
    std::function<bool()> go_on;
  };
  /// Starts `program` many times, as Spawn() does, but as copies of one process of it (system/nursery.h), which it must
  /// know how to make. Returns their process ids, in the order of `copies`; none if `go_on` returned false. This
  /// process must have adopted its descendants. Throws std::runtime_error if they cannot be started.
  std::vector<pid_t> SpawnCopies(const std::string& program, const std::vector<CopyOf>& copies,
                                 const Patience& patience);
  /// Reaps children. Returns those that have ended since the last call.
  std::vector<Exit> Reap();
  /// Waits at most `grace` until all children have ended, and reaps them. Returns whether all have.
  bool WaitAll(std::chrono::milliseconds grace);
  /// Sends SIGTERM, and after `grace` SIGKILL to the children that are left; reaps all. May be called again.
  void Stop(std::chrono::milliseconds grace);
  bool empty() const { return running_.empty(); }
  /// Sends SIGKILL to all children and reaps them.
  void Kill();
  /// The same for the children of this name: Reap() does not tell of them.
  void Kill(const std::string& process);
  /// When the last child was reaped that a signal has killed, from here or not; nothing: none was.
  std::optional<std::chrono::steady_clock::time_point> killed_at() const { return killed_at_; }

 private:
  void Signal(int signal);
  std::optional<int> Reap(ChildProcess& child);

  ChildLogs& logs_;
  std::vector<int> shared_;
  struct Child {
    std::string name;
    ChildProcess process;
  };
  std::vector<Child> running_;
  std::optional<std::chrono::steady_clock::time_point> killed_at_;
};

}  // namespace mascot
