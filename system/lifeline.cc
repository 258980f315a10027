#include "system/lifeline.h"

#include <fcntl.h>
#include <signal.h>

#include <cerrno>
#include <system_error>

namespace mascot {

// The kernel sends a signal to the owner of a pipe's end (F_SETOWN) when something happens to the pipe (O_ASYNC).
// Nobody writes into this pipe, so that this is when its last writer has ended.
void Lifeline::Tie(pid_t child) {
  const int end = pipe_.reads.number();
  if (fcntl(end, F_SETOWN, child) < 0 || fcntl(end, F_SETSIG, SIGKILL) < 0 ||
      fcntl(end, F_SETFL, O_RDONLY | O_ASYNC) < 0)
    throw std::system_error(errno, std::generic_category(), "cannot tie a process to this one");
  pipe_.reads = Descriptor();
}

}  // namespace mascot
