#include "system/child_process.h"

#include <signal.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

namespace mascot {

void SignalProcess(pid_t process, int signal) {
  if (process > 0) kill(process, signal);
}

std::string EndText(int status) {
  if (WIFSIGNALED(status))
    return "was killed by signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
  if (WIFEXITED(status)) return "exited with code " + std::to_string(WEXITSTATUS(status));
  return "has ended, and it cannot be told how";
}

ChildProcess::~ChildProcess() {
  Signal(SIGKILL);
  Reap();
}

std::optional<int> ChildProcess::Reap(bool wait) {
  if (number_ <= 0) return std::nullopt;
  int status = 0;
  pid_t ended = 0;
  do ended = waitpid(number_, &status, wait ? 0 : WNOHANG);
  while (ended < 0 && errno == EINTR);
  if (ended == 0) return std::nullopt;
  number_ = 0;
  return ended > 0 ? status : kUnknownEnd;
}

}  // namespace mascot
