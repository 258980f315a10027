#pragma once

#include <sys/types.h>

#include <span>
#include <string>

#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "system/child_process.h"
#include "system/descriptor.h"

namespace mascot {

/// A process that outlives the other processes of a run, kills the processes that their laws have started and that bear
/// the mark of the run (MarkDescendants(), to be called before), and removes what they leave in shared memory. It waits
/// for the end of a pipe whose other end the orchestrator and all processes that it spawned have open: when the last of
/// them has ended, in whatever way, it sweeps. Until then it also keeps the domain locked, if there is one.
class Janitor {
 public:
  /// Starts the process. Throws std::runtime_error if it cannot be started.
  explicit Janitor(const DomainLock& lock);
  Janitor();   ///< of a run in one process, without a domain
  ~Janitor();  ///< leaves the process to its work
  Janitor(const Janitor&) = delete;
  Janitor& operator=(const Janitor&) = delete;

  /// Sets the contents that this file gets if the run ends without Dismiss() and the file does not exist.
  void LeaveWords(const std::string& path, const std::string& text) const;
  /// The end of the pipe that every process of the run has to inherit.
  int lifeline() const { return lifeline_.number(); }
  pid_t process() const { return process_.number(); }
  /// Ends the process: the caller has removed the shared memory itself. May be called again.
  void Dismiss();

 private:
  void Start(int domain, std::span<const int> lock);

  Descriptor lifeline_;
  ChildProcess process_;
};

}  // namespace mascot
