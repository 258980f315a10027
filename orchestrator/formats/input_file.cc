#include "orchestrator/formats/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <system_error>

namespace mascot {
namespace {

[[noreturn]] void Fail(const std::string& what, const std::string& path, const std::string& why) {
  throw std::runtime_error("cannot " + what + " " + path + ": " + why);
}

std::string Reason(int error) { return std::generic_category().message(error); }

/// Opens `path` without blocking: if it is a pipe, open() would otherwise wait for a writer.
int Open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) Fail("open", path, Reason(errno));
  return fd;
}

std::uint64_t RegularSize(int fd, const std::string& path) {
  struct stat status {};
  if (::fstat(fd, &status) != 0) Fail("open", path, Reason(errno));
  if (S_ISDIR(status.st_mode)) Fail("open", path, Reason(EISDIR));
  if (!S_ISREG(status.st_mode)) Fail("open", path, "not a regular file");
  return static_cast<std::uint64_t>(status.st_size);
}

}  // namespace

InputFile::InputFile(const std::string& path) : path_(path), fd_(Open(path)) {
  try {
    size_ = RegularSize(fd_, path);
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

InputFile::~InputFile() { ::close(fd_); }

void InputFile::Read(std::uint64_t offset, std::uint64_t bytes, Bytes& out) const {
  out.resize(static_cast<std::size_t>(std::min(bytes, size_ - std::min(offset, size_))));
  for (std::size_t done = 0; done < out.size();) {
    const ssize_t got = ::pread(fd_, &out[done], out.size() - done, static_cast<off_t>(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) Fail("read", path_, Reason(errno));
    if (got == 0) out.resize(done);  // the file has become shorter
    done += static_cast<std::size_t>(got);
  }
}

}  // namespace mascot
