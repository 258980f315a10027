#pragma once

#include <functional>
#include <optional>

#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "orchestrator/engines/dds/machine/janitor.h"
#include "system/stop_signal.h"

namespace mascot {

/// A DDS domain that no run of this machine uses: locked, swept before and after, and swept by a janitor if this
/// process is killed. Of what replays recordings.
class OwnDomain {
 public:
  /// As DomainLock(). Throws what that and Janitor() throw.
  explicit OwnDomain(int wanted);

  int domain() const { return lock_.domain(); }
  const DomainLock& lock() const { return lock_; }
  const Janitor& janitor() const { return *janitor_; }
  /// Calls `leave`, which leaves the domain, and removes the shared memory. Returns whether the DDS library let go
  /// within 5 s and before a signal. If not, its threads go on, and this process has to end by _exit(); the janitor
  /// then sweeps. Throws what `leave` throws.
  bool Leave(std::function<void()> leave, StopSignal& stop);

 private:
  DomainLock lock_;
  std::optional<Janitor> janitor_;
};

}  // namespace mascot
