#include "system/left_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace mascot {

bool WriteAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = write(descriptor, bytes.data(), bytes.size());
    if (put == 0) errno = EIO;
    if (put == 0 || (put < 0 && errno != EINTR)) return false;
    if (put > 0) bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

LeftFile::LeftFile(const char* path)
    : path_(path), file_(open(path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666)) {}

LeftFile::~LeftFile() {
  if (file_ < 0) return;
  if (close(file_) != 0) is_whole_ = false;
  if (!is_whole_) unlink(path_);
}

void LeftFile::Write(std::string_view bytes) {
  if (file_ >= 0 && is_whole_) is_whole_ = WriteAll(file_, bytes);
}

}  // namespace mascot
