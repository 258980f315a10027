#pragma once

#include <fcntl.h>
#include <unistd.h>

namespace mascot {

/// A program that was started with a standard stream closed would get its descriptor for its next file, and
/// print into that: what is closed is opened on /dev/null. First thing in main.
inline void OpenStandardStreams() {
  for (int descriptor = open("/dev/null", O_RDWR); descriptor >= 0; descriptor = open("/dev/null", O_RDWR))
    if (descriptor > STDERR_FILENO) {
      close(descriptor);
      return;
    }
}

}  // namespace mascot
