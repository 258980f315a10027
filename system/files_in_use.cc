#include "system/files_in_use.h"

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <system_error>

#include "system/processes.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

/// Adds the files that a process has open (`process`: its folder in /proc).
void AddOpen(const fs::path& process, const std::string& prefix, std::set<FileId>& used) {
  std::error_code error;
  for (const fs::path& descriptor : PathsIn(process / "fd"))
    if (fs::read_symlink(descriptor, error).string().starts_with(prefix)) used.insert(IdOf(descriptor));
}

/// Adds the files that a process maps.
void AddMapped(const fs::path& process, const std::string& prefix, std::set<FileId>& used) {
  std::ifstream maps(process / "maps");
  for (std::string line; std::getline(maps, line);) {
    unsigned major = 0, minor = 0;
    unsigned long inode = 0;
    if (line.find(prefix) != line.npos &&
        std::sscanf(line.c_str(), "%*s %*s %*s %x:%x %lu", &major, &minor, &inode) == 3)
      used.emplace(makedev(major, minor), inode);
  }
}

}  // namespace

FileId IdOf(const std::string& path) {
  struct stat info {};
  return stat(path.c_str(), &info) == 0 ? FileId{info.st_dev, info.st_ino} : FileId{};
}

std::set<FileId> FilesInUse(const std::string& prefix) {
  std::set<FileId> used;
  for (const pid_t pid : Processes()) {
    if (pid == getpid()) continue;
    const fs::path process = "/proc/" + std::to_string(pid);
    AddOpen(process, prefix, used);
    AddMapped(process, prefix, used);
  }
  return used;
}

std::vector<fs::path> PathsIn(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    paths.push_back(entry->path());
  return paths;
}

}  // namespace mascot
