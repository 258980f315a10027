#include "system/descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace mascot {

Descriptor::~Descriptor() {
  if (is_open()) ::close(number_);
}

std::string ReadToEnd(int descriptor) {
  std::string text;
  for (;;) {
    char bytes[4096];
    const ssize_t got = ::read(descriptor, bytes, sizeof bytes);
    if (got == 0) return text;
    if (got > 0) text.append(bytes, static_cast<std::size_t>(got));
    if (got < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "cannot read a pipe");
  }
}

Pipe MakePipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
  return {.reads = Descriptor(ends[0]), .writes = Descriptor(ends[1])};
}

}  // namespace mascot
