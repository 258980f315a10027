#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// Beginning of the failure text of a task whose process crashed, was killed or exited.
inline constexpr std::string_view kLostProcess = "the process ";

/// Pool of worker processes, each of which runs one task at a time. If a task crashes its process, only this task
/// fails, and the process is replaced. Construct it before any threads or a Python interpreter are started: fork() does
/// not copy them properly.
class WorkerPool {
 public:
  /// Runs in a worker process and returns the answer to a task. An exception becomes the failure of the task.
  using Work = std::function<std::string(std::size_t task)>;
  struct Done {
    std::size_t task = 0;
    std::string answer;
    std::string failure;  ///< empty: none; if the process was lost: kLostProcess, "was killed by signal 11 (...)"
  };

  WorkerPool(int workers, Work work);
  ~WorkerPool();  ///< kills and reaps all workers
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  bool HasIdle() const;
  bool IsBusy() const;
  /// Gives `task` to an idle worker. HasIdle() must be true.
  void Start(std::size_t task);
  /// Waits for a finished task; nothing if there is none within `timeout`.
  std::optional<Done> Wait(std::chrono::milliseconds timeout);

 private:
  struct Worker {
    pid_t pid = 0;  // 0: reaped, and not forked again yet
    int socket = -1;
    std::optional<std::size_t> task;
  };
  Worker Fork();
  [[noreturn]] void Serve(int socket) const;
  /// Waits for the end of a worker process. Returns how it ended, as Exit::Text.
  std::string Reap(Worker& worker) const;

  Work work_;
  std::vector<Worker> workers_;
};

}  // namespace mascot
