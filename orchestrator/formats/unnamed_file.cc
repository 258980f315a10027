#include "orchestrator/formats/unnamed_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "orchestrator/formats/create_file.h"

namespace mascot {
namespace {

constexpr std::uint64_t kMovedAtOnce = std::uint64_t{1} << 20;

/// Where an open file can be found to give it a name.
std::string NameOf(int fd) { return "/proc/self/fd/" + std::to_string(fd); }

/// Opens a file without a name in the folder of `path`; -1 if the file system has none, if there is no such folder, or
/// if it could not be named later.
int OpenUnnamed(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const int fd = ::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (fd < 0 || ::access(NameOf(fd).c_str(), F_OK) == 0) return fd;
  ::close(fd);
  return -1;
}

/// Calls pread or pwrite until all of `bytes` are through.
template <class Call, class Byte>
bool Fully(Call call, int fd, std::span<Byte> bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    const ssize_t done = call(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done == 0) errno = EIO;  // the file was shortened
    if (done <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(done));
    offset += static_cast<std::uint64_t>(done);
  }
  return true;
}

}  // namespace

UnnamedFile::UnnamedFile(const std::string& path, WithoutName without_name) : part_(path) {
  RemoveFile(part_.name());  // now: what it refuses is not to be found at the end of a long run
  if (without_name == WithoutName::kIfPossible) fd_ = OpenUnnamed(path);
  has_name_ = fd_ < 0;
  if (has_name_) fd_ = CreateFile(part_.name(), O_RDWR);
}

UnnamedFile::~UnnamedFile() {
  if (fd_ >= 0) ::close(fd_);
}

void UnnamedFile::WriteAt(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  if (!Fully(::pwrite, fd_, bytes, offset)) Fail("write");
}

void UnnamedFile::Resize(std::uint64_t size) {
  if (!TryResize(size)) Fail("write");
}

bool UnnamedFile::TryResize(std::uint64_t size) { return ::ftruncate(fd_, static_cast<off_t>(size)) == 0; }

void UnnamedFile::Move(std::uint64_t from, std::uint64_t to, std::uint64_t size) {
  if (from == to) return;
  std::vector<std::uint8_t> bytes;
  for (std::uint64_t done = 0; done < size; done += bytes.size()) {
    bytes.resize(std::min(kMovedAtOnce, size - done));
    const std::uint64_t at =
        to < from ? done : size - done - bytes.size();  // no byte is written that is still to be read
    if (!Fully(::pread, fd_, std::span(bytes), from + at)) Fail("read");
    WriteAt(to + at, bytes);
  }
}

void UnnamedFile::Commit(std::uint64_t size) {
  Resize(size);
  if (::fsync(fd_) != 0) Fail("flush");
  if (!has_name_) {
    RemoveFile(part_.name());
    if (::linkat(AT_FDCWD, NameOf(fd_).c_str(), AT_FDCWD, part_.name().c_str(), AT_SYMLINK_FOLLOW) != 0) Fail("create");
  }
  if (::close(std::exchange(fd_, -1)) != 0) Fail("close");
  part_.Commit();
}

void UnnamedFile::Fail(const char* what) const {
  throw std::runtime_error("cannot " + std::string(what) + " " + part_.name() + ": " +
                           std::generic_category().message(errno));
}

}  // namespace mascot
