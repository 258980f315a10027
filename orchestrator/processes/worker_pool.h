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

/// How the failure of a task begins that took its process down.
inline constexpr std::string_view kLostProcess = "the process ";

/// Processes that work off tasks, one at a time each. A task that takes its process down is that task's failure only:
/// the next one gets a new process. Make it before anything starts threads or an interpreter, which a fork would copy
/// badly.
class WorkerPool {
 public:
  /// Runs in a worker: the answer to a task. What it throws becomes the failure.
  using Work = std::function<std::string(std::size_t task)>;
  struct Done {
    std::size_t task = 0;
    std::string answer;
    std::string failure;  ///< empty: none; of a lost process kLostProcess "was killed by signal 11 (...)"
  };

  WorkerPool(int workers, Work work);
  ~WorkerPool();  ///< kills those that still work
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  bool HasIdle() const;
  bool IsBusy() const;
  /// Gives `task` to an idle worker.
  void Start(std::size_t task);
  /// A finished task, or nothing within `timeout`.
  std::optional<Done> Wait(std::chrono::milliseconds timeout);

 private:
  struct Worker {
    pid_t pid = -1;
    int socket = -1;
    std::optional<std::size_t> task;
  };
  Worker Fork();
  [[noreturn]] void Serve(int socket) const;
  std::string Bury(Worker& worker) const;

  Work work_;
  std::vector<Worker> workers_;
};

}  // namespace mascot
