#include "orchestrator/formats/create_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace mascot {
namespace {

[[noreturn]] void Refuse(const std::string& path, const std::string& why) {
  throw std::runtime_error("cannot create " + path + ": " + why);
}

std::string Why(int error) { return std::generic_category().message(error); }

/// What has a name, if it is no regular file.
std::string Named(mode_t mode) {
  if (S_ISDIR(mode)) return Why(EISDIR);
  const char* what = S_ISLNK(mode) ? "symbolic link" : S_ISFIFO(mode) ? "pipe" : S_ISSOCK(mode) ? "socket" : "device";
  return std::string("a ") + what + " has this name";
}

}  // namespace

int CreateFile(const std::string& path, int access) {
  for (int tries = 0;; ++tries) {
    const int fd = ::open(path.c_str(), access | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd >= 0) return fd;
    if (errno != EEXIST || tries > 0) Refuse(path, Why(errno));
    RemoveFile(path);
  }
}

void RemoveFile(const std::string& path) {
  struct stat there {};
  if (::lstat(path.c_str(), &there) != 0) return;
  if (!S_ISREG(there.st_mode)) Refuse(path, Named(there.st_mode));
  if (::unlink(path.c_str()) != 0) Refuse(path, Why(errno));
}

void RequireReplaceable(const std::string& path) {
  struct stat there {};
  if (::lstat(path.c_str(), &there) != 0 || S_ISREG(there.st_mode) || S_ISLNK(there.st_mode)) return;
  Refuse(path, Named(there.st_mode));
}

}  // namespace mascot
