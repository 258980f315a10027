#include "bus/resources.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "system/control_groups.h"
#include "system/processes.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
/// Processes of a run reserve 0.6 to 1.2 GiB if they may, mostly stacks and heaps of threads. With 180 to 300 MiB some
/// start and some do not.
constexpr std::uint64_t kAddressSpace = 512 * kMiB;
/// They use a part of it: with 60 MB some threads do not start, with 150 MB all do.
constexpr std::uint64_t kData = 192 * kMiB;
/// Memory of its own that a process takes at least; one without shared memory of the run and without Python.
constexpr std::uint64_t kMemory = 8 * kMiB;
/// A process with a participant has 10 threads, the orchestrator up to 20.
constexpr int kThreads = 10, kMoreThreads = 12;

// --- memory -------------------------------------------------------------------------------------------

void RequireMemory(__rlimit_resource_t which, const char* what, const char* option, std::uint64_t needed) {
  rlimit limit{};
  if (getrlimit(which, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= needed) return;
  throw std::runtime_error(
      fmt::format("the {} of a process is limited to {} MiB (ulimit {}), and a run over DDS needs {} MiB", what,
                  limit.rlim_cur / kMiB, option, needed / kMiB));
}

void RequireSharedMemory(std::uint64_t needed) {
  if (access("/dev/shm", W_OK | X_OK) != 0)
    throw std::runtime_error(
        fmt::format("/dev/shm cannot be written ({}), where Fast DDS has its shared memory: mount "
                    "it, or set network.transport = \"udp\"",
                    std::strerror(errno)));
  struct statvfs info {};
  if (statvfs("/dev/shm", &info) != 0) return;
  const std::uint64_t free = static_cast<std::uint64_t>(info.f_bavail) * info.f_frsize;
  if (needed <= free) return;
  throw std::runtime_error(fmt::format(
      "/dev/shm has {:.1f} MiB free, and this run needs {:.1f} MiB: enlarge it (mount -o remount,size=..., docker run "
      "--shm-size=...), let agents share processes (network.agents_per_process), or set network.transport = \"udp\"",
      static_cast<double>(free) / kMiB, static_cast<double>(needed) / kMiB));
}

void RequireMemoryOfControlGroups(std::uint64_t needed) {
  for (const fs::path& group : ControlGroups("memory"))
    if (const auto memory = MemoryOfGroup(group); memory && memory->used + needed > memory->limit)
      throw std::runtime_error(
          fmt::format("this control group may have {} MiB of memory ({}) and has {} MiB, and this run needs about {} "
                      "MiB more: raise "
                      "the limit, or let agents share processes (network.agents_per_process)",
                      memory->limit / kMiB, memory->file.string(), memory->used / kMiB, needed / kMiB));
}

// --- descriptors --------------------------------------------------------------------------------------

void RequireDescriptors(int needed) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= static_cast<rlim_t>(needed)) return;
  const rlim_t was = limit.rlim_cur;
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, static_cast<rlim_t>(needed));
  if (limit.rlim_max >= static_cast<rlim_t>(needed) && setrlimit(RLIMIT_NOFILE, &limit) == 0) return;
  throw std::runtime_error(
      fmt::format("a process may have {} open files (ulimit -n), and this run needs {}: raise the limit{}", was, needed,
                  needed > 256 ? ", or let agents share processes (network.agents_per_process)" : ""));
}

// --- threads ------------------------------------------------------------------------------------------

/// Whether the limit of ulimit -u does not hold for us (setrlimit(2)).
bool MayHaveAnyNumberOfThreads() {
  constexpr unsigned kSysAdmin = 21, kSysResource = 24;  // capabilities(7)
  if (getuid() == 0) return true;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    unsigned long long effective = 0;
    if (word == "CapEff:" && status >> std::hex >> effective)
      return ((effective >> kSysAdmin) & 1U) != 0 || ((effective >> kSysResource) & 1U) != 0;
  }
  return false;
}

/// The number of threads in a line of /proc/PID/stat.
int ThreadsIn(const std::string& stat) {
  constexpr int kFields = 17;  // from the state to the number of threads
  const auto end = stat.rfind(')');
  if (end == std::string::npos) return 0;
  std::istringstream fields(stat.substr(end + 1));
  std::string skipped;
  for (int field = 0; field < kFields; ++field) fields >> skipped;
  int threads = 0;
  fields >> threads;
  return threads;
}

/// The threads of our user that can be seen.
int ThreadsOfUser() {
  int threads = 0;
  for (const pid_t pid : Processes()) {
    const std::string process = "/proc/" + std::to_string(pid);
    struct stat info {};
    if (::stat(process.c_str(), &info) != 0 || info.st_uid != getuid()) continue;
    std::string stat;
    std::getline(std::ifstream(process + "/stat"), stat, '\0');
    threads += ThreadsIn(stat);
  }
  return threads;
}

[[noreturn]] void RefuseThreads(const std::string& who, const std::string& by, long limit, long used, int needed) {
  throw std::runtime_error(fmt::format(
      "{} may have {} processes and threads ({}) and has {}, and this run needs about {} more: raise the limit, or let "
      "agents share processes (network.agents_per_process)",
      who, limit, by, used, needed));
}

void RequireThreadsOfUser(int needed) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NPROC, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || MayHaveAnyNumberOfThreads()) return;
  const int used = ThreadsOfUser();
  if (limit.rlim_cur >= static_cast<rlim_t>(used) + static_cast<rlim_t>(needed)) return;
  RefuseThreads("this user", "ulimit -u", static_cast<long>(limit.rlim_cur), used, needed);
}

void RequireThreadsOfControlGroups(int needed) {
  for (const fs::path& group : ControlGroups("pids")) {
    const auto limit = NumberInGroup(group / "pids.max"), used = NumberInGroup(group / "pids.current");
    if (limit && used && *limit < *used + static_cast<std::uint64_t>(needed))
      RefuseThreads("this control group", (group / "pids.max").string(), static_cast<long>(*limit),
                    static_cast<int>(*used), needed);
  }
}

}  // namespace

void RequireResources(const ResourceNeeds& needs) {
  RequireMemory(RLIMIT_AS, "address space", "-v", kAddressSpace);
  RequireMemory(RLIMIT_DATA, "data", "-d", kData);
  if (needs.shared_memory > 0) RequireSharedMemory(needs.shared_memory);
  RequireMemoryOfControlGroups(needs.shared_memory + kMemory * static_cast<std::uint64_t>(needs.processes));
  RequireDescriptors(needs.descriptors);
  const int threads = kThreads * needs.processes + kMoreThreads;
  RequireThreadsOfUser(threads);
  RequireThreadsOfControlGroups(threads);
}

}  // namespace mascot
