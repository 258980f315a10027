#include "bus/shared_memory.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {
namespace {

namespace fs = std::filesystem;
constexpr const char* kFolder = "/dev/shm";

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

/// Paths of the files of each segment or port, by its name.
std::map<std::string, std::vector<std::string>> Segments() {
  std::map<std::string, std::vector<std::string>> segments;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(kFolder, error)) {
    const std::string name = entry.path().filename();
    const std::string segment = SegmentOf(name);
    if (segment.starts_with("fastrtps_") && IsOurs(entry.path())) segments[segment].push_back(entry.path());
  }
  return segments;
}

/// Names of all files in /dev/shm that another process maps. This process does not count: it has no participant any
/// more, but Fast DDS may still map segments of peers that died.
std::set<std::string> MappedNames() {
  std::set<std::string> names;
  std::error_code error;
  const std::string prefix = std::string(kFolder) + "/";
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const std::string pid = entry.path().filename();
    if (pid == std::to_string(getpid())) continue;
    if (!std::all_of(pid.begin(), pid.end(), [](unsigned char c) { return std::isdigit(c); })) continue;
    std::ifstream maps(entry.path() / "maps");
    for (std::string line; std::getline(maps, line);)
      if (const auto at = line.find(prefix); at != std::string::npos) names.insert(line.substr(at + prefix.size()));
  }
  return names;
}

/// True if the file's owner is alive: owners lock X_el exclusively and X_sl shared. We try the weakest lock that
/// conflicts with the owner's, so that two processes that check X_el at once do not take each other for the owner.
bool IsLocked(const std::string& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = flock(fd, (path.ends_with("_sl") ? LOCK_EX : LOCK_SH) | LOCK_NB) != 0;
  close(fd);
  return locked;
}

}  // namespace

std::vector<std::string> StaleSharedMemory() {
  // First the files, then the mappings: a file that a starting process has just made is mostly mapped or locked by
  // then.
  const auto segments = Segments();
  if (segments.empty()) return {};
  const std::set<std::string> mapped = MappedNames();
  std::vector<std::string> stale;
  for (const auto& [segment, files] : segments)
    if (!mapped.contains(segment) && std::none_of(files.begin(), files.end(), IsLocked))
      stale.insert(stale.end(), files.begin(), files.end());
  return stale;
}

void SweepSharedMemory() {
  const std::vector<std::string> once = StaleSharedMemory();
  if (once.empty()) return;
  poll(nullptr, 0, 50);  // milliseconds: a process that has just made one of the files maps or locks it in this time
  const std::vector<std::string> again = StaleSharedMemory();
  for (const std::string& file : once)
    if (std::ranges::find(again, file) != again.end()) unlink(file.c_str());
}

}  // namespace mascot
