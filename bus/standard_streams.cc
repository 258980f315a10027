#include "bus/standard_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace mascot {
namespace {

bool NobodyReads(int descriptor) {
  pollfd end{descriptor, 0, 0};
  return ::poll(&end, 1, 0) > 0 && (end.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

void OpenStandardStreams() {
  for (int descriptor = ::open("/dev/null", O_RDWR); descriptor >= 0; descriptor = ::open("/dev/null", O_RDWR))
    if (descriptor > STDERR_FILENO) {
      ::close(descriptor);
      return;
    }
}

void FlushStandardOutput() {
  const bool failed_before = !std::cout;
  std::cout.clear();
  errno = 0;
  if (std::cout.flush() && !failed_before) return;
  const int error = errno;
  std::cout.clear();
  ::__fpurge(stdout);
  if (NobodyReads(STDOUT_FILENO)) return;
  throw std::runtime_error("cannot write to standard output" +
                           (error != 0 ? ": " + std::generic_category().message(error) : std::string()));
}

}  // namespace mascot
