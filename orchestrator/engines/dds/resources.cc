#include "orchestrator/engines/dds/resources.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/statvfs.h>

#include <stdexcept>

namespace mascot {
namespace {

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
/// Processes of a run reserve 0.6 to 1.2 GiB if they may, mostly stacks and heaps of threads. With 180 to 300 MiB some
/// start and some do not.
constexpr std::uint64_t kAddressSpace = 512 * kMiB;

void RequireAddressSpace() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= kAddressSpace) return;
  throw std::runtime_error(
      fmt::format("the address space of a process is limited to {} MiB (ulimit -v), and a run over DDS needs {} MiB",
                  limit.rlim_cur / kMiB, kAddressSpace / kMiB));
}

void RequireSharedMemory(std::uint64_t needed) {
  struct statvfs info {};
  if (statvfs("/dev/shm", &info) != 0) return;
  const std::uint64_t free = static_cast<std::uint64_t>(info.f_bavail) * info.f_frsize;
  if (needed <= free) return;
  throw std::runtime_error(fmt::format(
      "/dev/shm has {:.1f} MiB free, and this run needs {:.1f} MiB: enlarge it (mount -o remount,size=..., docker run "
      "--shm-size=...), let agents share processes (network.agents_per_process), or set network.transport = \"udp\"",
      static_cast<double>(free) / kMiB, static_cast<double>(needed) / kMiB));
}

}  // namespace

void RequireResources(std::uint64_t shared_memory) {
  RequireAddressSpace();
  if (shared_memory > 0) RequireSharedMemory(shared_memory);
}

}  // namespace mascot
