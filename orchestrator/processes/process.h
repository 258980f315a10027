#pragma once

#include <sys/types.h>

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "orchestrator/processes/console.h"
#include "orchestrator/recording/run_folder.h"

namespace mascot {

/// Folder of the running program.
std::filesystem::path ProgramFolder();

/// Copies what children print to their log files and to the console, and keeps their last lines.
class ChildLogs {
 public:
  ChildLogs(const RunFolder& folder, Console& console);
  ~ChildLogs();  ///< when what is in the pipes is copied; for after the children have gone
  ChildLogs(const ChildLogs&) = delete;
  ChildLogs& operator=(const ChildLogs&) = delete;

  /// A pipe whose reading end this copies; returns the end to write to, which the caller closes.
  int Open(const std::string& process);
  /// The last lines that `process` printed. Waits, briefly, for those still in the pipe of a dead child.
  std::vector<std::string> LastLines(const std::string& process);

 private:
  struct Stream;
  void Copy();
  void Read(Stream& stream);
  void Close(Stream& stream);
  void TakeLine(Stream& stream, const std::string& line);

  const RunFolder& folder_;
  Console& console_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Stream>> streams_;
  int wake_[2];
  bool closing_ = false;
  std::thread thread_;  // last
};

/// How a child ended.
struct Exit {
  std::string process;
  int status = 0;  ///< of waitpid
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

  /// Starts `program` (a path) with `arguments`. Throws std::runtime_error if it cannot be started.
  void Spawn(const std::string& process, const std::string& program, const std::vector<std::string>& arguments);
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
