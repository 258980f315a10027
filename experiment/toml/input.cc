#include "experiment/toml/input.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "base/number.h"
#include "base/utf8.h"
#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

constexpr const char* kStdin = "<stdin>";

/// Owns a descriptor.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

[[noreturn]] void Refuse(const std::string& name, const std::string& why) {
  throw ConfigError({PlainLine(name) + ": " + why});
}

[[noreturn]] void RefuseSize(const std::string& name, std::size_t max) {
  Refuse(name, "is larger than " + std::to_string(max >> 20) + " MiB");
}

[[noreturn]] void FailToRead(const std::string& name) {
  Refuse(name, std::string("cannot be read: ") + std::strerror(errno));
}

/// Reads up to the end, waiting for what is still to come.
std::string ReadAll(int descriptor, const std::string& name, std::size_t max = kLargestFile) {
  std::string text;
  char buffer[1 << 16];
  for (;;) {
    const ssize_t got = ::read(descriptor, buffer, sizeof buffer);
    if (got == 0) return text;
    if (got < 0 && errno == EAGAIN) {
      pollfd more{descriptor, POLLIN, 0};
      ::poll(&more, 1, -1);
    } else if (got < 0 && errno != EINTR) {
      FailToRead(name);
    } else if (got > 0) {
      text.append(buffer, static_cast<std::size_t>(got));
      if (text.size() > max) RefuseSize(name, max);  // perhaps it grew while we read
    }
  }
}

struct stat StatusOf(int descriptor, const std::string& name) {
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) FailToRead(name);
  if (S_ISDIR(status.st_mode)) Refuse(name, "is a directory");
  return status;
}

}  // namespace

std::optional<int> DescriptorOf(const std::string& path) {
  if (path == "-" || path == "/dev/stdin") return STDIN_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"})
    if (path.starts_with(folder)) return NumberFrom<int>(std::string_view(path).substr(folder.size()));
  return std::nullopt;
}

std::string NameOfInput(const std::string& path) { return DescriptorOf(path) == STDIN_FILENO ? kStdin : path; }

std::string StemOfInput(const std::string& name) {
  return name == kStdin || DescriptorOf(name) ? "" : std::filesystem::path(name).stem().string();
}

std::string ReadInput(const std::string& path) {
  const std::optional<int> open = DescriptorOf(path);
  if (!open) return ReadRegularFile(path);
  const std::string name = NameOfInput(path);
  const Descriptor copy(::fcntl(*open, F_DUPFD_CLOEXEC, 0));
  StatusOf(copy.number(), name);
  return ReadAll(copy.number(), name);
}

std::string ReadRegularFile(const std::string& path, std::size_t max) {
  // Non-blocking: opening a FIFO that has no writer would wait for ever.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  const struct stat status = StatusOf(file.number(), path);
  if (!S_ISREG(status.st_mode)) Refuse(path, "is not a regular file");
  if (static_cast<std::size_t>(status.st_size) > max) RefuseSize(path, max);
  return ReadAll(file.number(), path, max);
}

}  // namespace mascot
