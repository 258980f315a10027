#include "system/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

namespace mascot {

FolderLock::FolderLock(const std::filesystem::path& folder)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  is_ours_ = folder_.is_open() && ::flock(folder_.number(), LOCK_EX | LOCK_NB) == 0;
  if (!is_ours_ && errno != EWOULDBLOCK)
    throw std::filesystem::filesystem_error("lock", folder, std::error_code(errno, std::generic_category()));
}

pid_t FolderLock::Holder() const {
  struct stat folder {};
  if (::fstat(folder_.number(), &folder) != 0) return 0;
  const std::string ours = fmt::format("{:02x}:{:02x}:{}", major(folder.st_dev), minor(folder.st_dev), folder.st_ino);
  std::ifstream locks("/proc/locks");  // a line: "1: FLOCK  ADVISORY  WRITE 1234 fe:00:5678 0 EOF"
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, advisory, access, place;
    pid_t process = 0;
    if (words >> number >> kind >> advisory >> access >> process >> place && kind == "FLOCK" && place == ours)
      return std::max(process, 0);
  }
  return 0;
}

}  // namespace mascot
