#include "orchestrator/engines/dds/own_domain.h"

#include <chrono>
#include <utility>

#include "bus/shared_memory.h"
#include "orchestrator/engines/dds/bounded_call.h"
#include "system/private_folder.h"

namespace mascot {

OwnDomain::OwnDomain(int wanted) : lock_(wanted) {
  SweepSharedMemory(lock_.domain());  // left by runs of which also the janitor was killed
  janitor_.emplace(lock_);
}

bool OwnDomain::Leave(std::function<void()> leave, StopSignal& stop) {
  if (!ReturnsWithin(std::chrono::seconds(5), std::move(leave), stop)) return false;
  SweepSharedMemory(lock_.domain());
  SweepPrivateFolders();  // of processes that were killed
  janitor_->Dismiss();
  return true;
}

}  // namespace mascot
