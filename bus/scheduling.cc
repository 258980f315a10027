#include "bus/scheduling.h"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string>

namespace mascot {
namespace {

constexpr int kPriority = 10;  // in 1..99: above all ordinary processes, below the kernel's own threads

void Warn(const char* key, const char* what) {
  std::cerr << "warning: run." << key << ": " << what << ": " << std::strerror(errno) << "; flying on without"
            << std::endl;
}

/// Calls `change` for every thread of this process. Returns false, with errno, as soon as one cannot be changed (one
/// that has ended does not count).
template <class Change>
bool ForEachThread(const Change& change) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task"))
    if (change(static_cast<pid_t>(std::stoi(entry.path().filename()))) != 0 && errno != ESRCH) return false;
  return true;
}

/// The core number `place`, modulo their number, of those that this process may use.
cpu_set_t CoreOf(int place) {
  cpu_set_t allowed, core;
  CPU_ZERO(&core);
  if (::sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) == 0) return core;
  int skip = place % CPU_COUNT(&allowed);
  std::size_t number = 0;
  while (!CPU_ISSET(number, &allowed) || skip-- > 0) ++number;
  CPU_SET(number, &core);
  return core;
}

bool SetPolicy(int policy, int priority) {
  const sched_param parameters{.sched_priority = priority};
  return ForEachThread([&](pid_t thread) { return ::sched_setscheduler(thread, policy, &parameters); });
}

}  // namespace

void ApplyScheduling(const Experiment& experiment, int place) {
  const auto& run = experiment.run;
  if (run.lock_memory && ::mlockall(MCL_CURRENT | MCL_FUTURE) != 0) Warn("lock_memory", "memory cannot be locked");
  if (run.pin_cores) {
    const cpu_set_t core = CoreOf(place);
    if (!ForEachThread([&](pid_t thread) { return ::sched_setaffinity(thread, sizeof core, &core); }))
      Warn("pin_cores", "threads cannot be pinned");
  }
  if (run.scheduler == Scheduler::kFifo) {
    if (!SetPolicy(SCHED_FIFO, kPriority)) Warn("scheduler", "SCHED_FIFO is not permitted");
  } else if (run.mode == Mode::kLockstep) {
    // Under SCHED_OTHER a woken process preempts the one that is just sending to it, so it wakes for each sample
    // instead of once per tick. SCHED_BATCH gives 6 to 50 % more ticks per second on two cores.
    SetPolicy(SCHED_BATCH, 0);  // always permitted
  }
}

}  // namespace mascot
