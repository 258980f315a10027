#pragma once

#include <fcntl.h>
#include <unistd.h>

namespace mascot {

/// Opens /dev/null for each of stdin, stdout and stderr that is closed. Otherwise the next file that the program opens
/// would get that descriptor, and prints would go into it. To be called first in main.
inline void OpenStandardStreams() {
  for (int descriptor = open("/dev/null", O_RDWR); descriptor >= 0; descriptor = open("/dev/null", O_RDWR))
    if (descriptor > STDERR_FILENO) {
      close(descriptor);
      return;
    }
}

}  // namespace mascot
