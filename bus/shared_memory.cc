#include "bus/shared_memory.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/number.h"
#include "bus/ports.h"
#include "system/files_in_use.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;
constexpr const char *kFolder = "/dev/shm", *kPrefix = "/dev/shm/";

/// Name of the segment or port X that a file belongs to: Fast DDS keeps X itself, its lock files X_el or X_sl, and
/// sem.X_mutex.
std::string SegmentOf(std::string name) {
  constexpr std::string_view kSemaphore = "sem.", kMutex = "_mutex";
  if (name.starts_with(kSemaphore) && name.ends_with(kMutex))
    name = name.substr(kSemaphore.size(), name.size() - kSemaphore.size() - kMutex.size());
  for (std::string_view lock : {"_el", "_sl"})
    if (name.ends_with(lock)) name.resize(name.size() - lock.size());
  return name;
}

bool IsOurs(const std::string& path) {
  struct stat info;
  return lstat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode) && info.st_uid == geteuid();
}

/// The port of this name; 0: it is a segment, whose name is random; -1: neither.
int PortOf(const std::string& name) {
  constexpr std::string_view kPort = "fastrtps_port";
  return name.starts_with(kPort) ? NumberFrom<int>(std::string_view(name).substr(kPort.size())).value_or(-1) : 0;
}

/// A lock of a byte of a file, or the question for one.
struct flock LockOf(int byte, short type) {
  struct flock place {};
  place.l_type = type;
  place.l_whence = SEEK_SET;
  place.l_start = byte;
  place.l_len = 1;
  return place;
}

/// Whether another process, or another open file of this one, has reserved this byte of the file (Reserve()). Reserves
/// nothing.
bool IsReserved(int file, int byte) {
  struct flock place = LockOf(byte, F_WRLCK);
  return ::fcntl(file, F_OFD_GETLK, &place) != 0 || place.l_type != F_UNLCK;
}

/// Reserves a byte of a file, which can be locked for reading only; so every process locks first, and then asks whether
/// another lock would be in the way of one for writing. Returns whether no other process has it. Throws
/// std::runtime_error if the byte cannot be locked.
bool Reserve(int file, int byte) {
  struct flock place = LockOf(byte, F_RDLCK);
  if (::fcntl(file, F_OFD_SETLK, &place) != 0) throw std::runtime_error(std::strerror(errno));
  return !IsReserved(file, byte);
}

/// /dev/shm, to reserve domains in.
class Reservations {
 public:
  Reservations() : folder_(::open(kFolder, O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {}
  /// Whether a run may have the port beyond its own: that of a domain, or one that the domain before it runs over into.
  bool IsOfARun(int port) const {
    const int domain = DomainOf(port);
    return !folder_.is_open() || IsReserved(folder_.number(), domain) || IsReserved(folder_.number(), domain - 1);
  }
  /// Keeps runs from it for as long as this object lives. Returns whether none has it.
  bool Take(int port) const {
    const int domain = DomainOf(port);
    return folder_.is_open() && Reserve(folder_.number(), domain) && Reserve(folder_.number(), domain - 1);
  }

 private:
  static int DomainOf(int port) { return (port - kPortBase) / kPortsPerDomain; }
  Descriptor folder_;
};

/// Whether the name is a segment's, or that of a port of a run in `domain`.
bool IsSegmentOrPortOf(int domain, const std::string& name) {
  const int port = PortOf(name);
  return port == 0 || (domain != kNoDomain && FirstPort(domain) <= port && port < FirstPort(domain + kDomainsPerRun));
}

/// Whether it is a port beyond those of a run in `domain`, which its participants have taken if they could not open
/// their own: Fast DDS tries two ports more each time (mutation_tries in bus/qos.cc).
bool IsPortBeyond(int domain, const std::string& name) {
  constexpr int kMaxTries = 1000;
  const int first = FirstPort(domain + kDomainsPerRun), port = PortOf(name);
  return domain != kNoDomain && first <= port && port < first + 2 * kMaxTries;
}

/// Paths of the files of each segment or port, by its name.
std::map<std::string, std::vector<std::string>> Segments(int domain) {
  std::map<std::string, std::vector<std::string>> segments;
  for (const fs::path& path : PathsIn(kFolder)) {
    const std::string name = SegmentOf(path.filename());
    const bool is_ours =
        IsSegmentOrPortOf(domain, name) || (IsPortBeyond(domain, name) && !Reservations().IsOfARun(PortOf(name)));
    if (name.starts_with("fastrtps_") && is_ours && IsOurs(path)) segments[name].push_back(path);
  }
  return segments;
}

/// True if the file's owner is alive, perhaps in another container that shares /dev/shm, where we do not see what it
/// has open: owners lock X_el exclusively and X_sl shared. We try the weakest lock that conflicts with the owner's, so
/// that two processes that check X_el at once do not take each other for the owner.
bool IsLocked(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = flock(fd, (path.ends_with("_sl") ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0;
  close(fd);
  return locked;
}

}  // namespace

Descriptor ReserveInSharedMemory(int domain) {
  Descriptor folder(::open(kFolder, O_RDONLY | O_DIRECTORY));  // without O_CLOEXEC: children inherit it
  if (!folder.is_open()) throw std::runtime_error(std::strerror(errno));
  return Reserve(folder.number(), domain) ? std::move(folder) : Descriptor();
}

std::vector<std::string> StaleSharedMemory(int domain) {
  const auto segments = Segments(domain);  // before FilesInUse(): what is made later is not stale
  if (segments.empty()) return {};
  // This process does not count: it has no participant any more, but Fast DDS may still map segments of dead peers.
  const std::set<FileId> used = FilesInUse(kPrefix);
  const auto in_use = [&](const std::string& path) { return used.contains(IdOf(path)) || IsLocked(path); };
  std::vector<std::string> stale;
  for (const auto& [segment, files] : segments)
    if (std::ranges::none_of(files, in_use)) stale.insert(stale.end(), files.begin(), files.end());
  return stale;
}

void SweepSharedMemory(int domain) {
  const std::vector<std::string> once = StaleSharedMemory(domain);
  if (once.empty()) return;
  poll(nullptr, 0, 50);             // milliseconds: the kernel shows a new file a moment before its maker has it open
  const Reservations reservations;  // so that no run begins to use a port beyond ours
  const auto may_remove = [&](const std::string& file) {
    const std::string name = SegmentOf(fs::path(file).filename());
    return IsSegmentOrPortOf(domain, name) || reservations.Take(PortOf(name));
  };
  const std::vector<std::string> again = StaleSharedMemory(domain);
  for (const std::string& file : once)
    if (std::ranges::find(again, file) != again.end() && may_remove(file)) unlink(file.c_str());
}

}  // namespace mascot
