#include "orchestrator/formats/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "orchestrator/formats/create_file.h"

namespace mascot {

bool WriteFully(int fd, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

OutputFile::OutputFile(std::string path) : path_(std::move(path)), fd_(CreateFile(path_, O_WRONLY)) {}

OutputFile::~OutputFile() {
  if (fd_ >= 0) ::close(fd_);
}

void OutputFile::Write(std::span<const std::uint8_t> bytes) {
  if (error_ != 0) Fail("write", error_);
  if (!WriteFully(fd_, bytes)) Fail("write", errno);
  size_ += bytes.size();
}

void OutputFile::SyncAndClose() {
  if (error_ != 0) Fail("close", error_);
  struct stat info {};
  if (::fstat(fd_, &info) == 0 && info.st_nlink == 0) Fail("complete", ENOENT);  // it was removed meanwhile
  if (::fsync(fd_) != 0) Fail("flush", errno);
  if (::close(std::exchange(fd_, -1)) != 0) Fail("close", errno);
}

void OutputFile::Fail(const std::string& what, int error) {
  error_ = error;
  throw std::runtime_error("cannot " + what + " " + path_ + ": " + std::generic_category().message(error));
}

}  // namespace mascot
