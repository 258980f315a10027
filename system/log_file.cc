#include "system/log_file.h"

#include <fcntl.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "system/left_file.h"

namespace mascot {
namespace {

std::string CannotWrite(const std::string& path, int error) {
  return "cannot write " + path + ": " + std::strerror(error);
}

}  // namespace

LogFile::LogFile(const std::filesystem::path& path, Tell tell)
    : path_(path.string()),
      file_(open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666)),
      tell_(std::move(tell)) {
  if (!file_.is_open()) throw std::runtime_error(CannotWrite(path_, errno));
}

void LogFile::Write(std::string_view text) {
  if (!file_.is_open() || WriteAll(file_.number(), text)) return;
  const int error = errno;
  file_ = Descriptor();
  tell_(CannotWrite(path_, error) + ": this log ends here, and what would follow is lost");
}

}  // namespace mascot
