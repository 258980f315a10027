#include "system/turn.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>

#include <cerrno>
#include <system_error>

namespace mascot {

Turn::Turn(const std::filesystem::path& name)
    : file_(::open(name.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR)) {
  const auto fail = [&name] {
    throw std::filesystem::filesystem_error("lock", name, std::error_code(errno, std::generic_category()));
  };
  if (!file_.is_open()) fail();
  while (::flock(file_.number(), LOCK_EX) != 0)
    if (errno != EINTR) fail();
}

}  // namespace mascot
