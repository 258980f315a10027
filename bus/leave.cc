#include "bus/leave.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>

#include "bus/process_main.h"
#include "system/end_now.h"
#include "system/stop_signal.h"

namespace mascot {
namespace {

// What LeaveByForce() needs, which must not allocate.
volatile sig_atomic_t leaving_code = 0, leaving_sweeps = 0;
char leaving_line[128] = "", leaving_code_text[16] = "";
volatile sig_atomic_t leaving_line_size = 0;

void Prepare(const Leaving& leaving) {
  leaving_code = leaving.code;
  leaving_sweeps = leaving.sweeps ? 1 : 0;
  std::snprintf(leaving_code_text, sizeof leaving_code_text, "%d", leaving.code);
  leaving_line_size = !leaving.says_so ? 0
                                       : std::snprintf(leaving_line, sizeof leaving_line,
                                                       "%.48s: the DDS library does not end: leaving by force\n",
                                                       leaving.process.c_str());
}

/// A signal handler. Fast DDS still maps the segments that this process has read; exec unmaps them, and closing all
/// files releases its own locks.
void LeaveByForce(int) {
  alarm(0);
  const auto size = static_cast<std::size_t>(leaving_line_size);
  const bool lives = size == 0 || write(STDERR_FILENO, leaving_line, size) != 0;
  if (leaving_sweeps != 0 && lives) {
    close_range(STDERR_FILENO + 1, ~0U, 0);
    execl("/proc/self/exe", "sweep", kSweep, leaving_code_text, nullptr);
  }
  EndNow(leaving_code);
}

void LeaveOn(int signal) {
  if (IsIgnored(signal)) return;  // nohup
  struct sigaction action {};
  action.sa_handler = LeaveByForce;
  sigaction(signal, &action, nullptr);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace

void LeaveWithin(std::chrono::seconds limit, const Leaving& leaving) {
  alarm(0);
  Prepare(leaving);
  LeaveOn(SIGALRM);
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    if (leaving.on_signals)
      LeaveOn(number);
    else
      signal(number, SIG_IGN);  // it ends anyway, and in order
  alarm(static_cast<unsigned>(limit.count()));
}

void LeaveNow(const Leaving& leaving) {
  Prepare(leaving);
  LeaveByForce(0);
  EndNow(leaving.code);
}

}  // namespace mascot
