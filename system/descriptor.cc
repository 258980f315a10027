#include "system/descriptor.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace mascot {

Descriptor::~Descriptor() {
  if (is_open()) ::close(number_);
}

Pipe MakePipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "cannot make a pipe");
  return {.reads = Descriptor(ends[0]), .writes = Descriptor(ends[1])};
}

}  // namespace mascot
