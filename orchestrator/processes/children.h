#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "orchestrator/processes/child_logs.h"

namespace mascot {

/// Folder of the running program.
std::filesystem::path ProgramFolder();

/// How a child ended.
struct Exit {
  std::string process;
  int status = 0;  ///< of waitpid
  /// Its exit code; nothing if a signal killed it.
  std::optional<int> code() const;
  /// "exited with code 3", "was killed by signal 11 (Segmentation fault)"
  std::string Text() const;
};

/// The processes of a run, each in a process group of its own with default signals, so that a Ctrl-C
/// reaches only the orchestrator. None outlives this object.
class Children {
 public:
  explicit Children(ChildLogs& logs) : logs_(logs) {}
  ~Children();  ///< kills and reaps what is left
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;

  /// Starts `program` (a path) with `arguments`; what it prints goes to the file `log`. Throws std::runtime_error if it
  /// cannot be started.
  void Spawn(const std::string& process, const std::string& program, const std::vector<std::string>& arguments,
             const std::filesystem::path& log);
  /// Children that have ended since the last call.
  std::vector<Exit> Reap();
  /// Waits until all have ended, at most `grace`. Returns whether they have.
  bool WaitAll(std::chrono::milliseconds grace);
  /// SIGTERM, and SIGKILL to what is left after `grace`. Reaps all. Twice is not an error.
  void Stop(std::chrono::milliseconds grace);
  void Kill();

 private:
  void Signal(int signal);

  ChildLogs& logs_;
  std::map<pid_t, std::string> running_;
};

}  // namespace mascot
