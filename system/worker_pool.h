#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "system/child_process.h"
#include "system/descriptor.h"

namespace mascot {

/// Beginning of the failure text of a task whose process crashed, was killed or exited.
inline constexpr std::string_view kLostProcess = "the process ";

/// Pool of worker processes, each of which runs one task at a time. If a task crashes its process, only this task
/// fails, and the process is replaced with the next task. Construct it before any threads or a Python interpreter are
/// started: fork() does not copy them properly. The destructor kills and reaps all workers.
class WorkerPool {
 public:
  /// Runs in a worker process and returns the answer to a task. An exception becomes the failure of the task.
  using Work = std::function<std::string(std::size_t task)>;
  struct Done {
    std::size_t task = 0;
    std::string answer;
    std::string failure;  ///< empty: none; if the process was lost: kLostProcess, "was killed by signal 11 (...)"
  };

  /// Throws std::system_error if a process cannot be started; then none is left.
  WorkerPool(int workers, Work work);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  bool HasIdle() const;
  bool IsBusy() const;
  /// Gives `task` to an idle worker. HasIdle() must be true. Throws std::system_error if the worker has no process and
  /// none can be started; then it has no task either.
  void Start(std::size_t task);
  /// Waits for a finished task; nothing if there is none within `timeout`.
  std::optional<Done> Wait(std::chrono::milliseconds timeout);

 private:
  struct Worker {
    ChildProcess process;  // none: the last one has ended, and the next task starts another
    Descriptor socket;
    std::optional<std::size_t> task = {};
  };
  Worker StartWorker() const;
  void Serve(int socket) const;

  Work work_;
  std::vector<Worker> workers_;
};

}  // namespace mascot
