#include "system/stop_signal.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace mascot {
namespace {

sigset_t Signals() {
  sigset_t set;
  sigemptyset(&set);
  for (int signal : {SIGINT, SIGTERM, SIGUSR1, SIGCHLD}) sigaddset(&set, signal);
  if (!IsIgnored(SIGHUP)) sigaddset(&set, SIGHUP);
  return set;
}

int Checked(int fd, const char* what) {
  if (fd < 0) throw std::system_error(errno, std::generic_category(), what);
  return fd;
}

}  // namespace

bool IsIgnored(int signal) {
  struct sigaction action {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

StopSignal::StopSignal(Hears hears) : hears_(hears) {
  const sigset_t set = Signals();
  if (hears_ == Hears::kSignals) pthread_sigmask(SIG_BLOCK, &set, nullptr);
  Open();
}

/// Makes the descriptors that are not there, or not any more.
void StopSignal::Open() {
  const sigset_t set = Signals();
  if (hears_ == Hears::kSignals && fcntl(signals_, F_GETFD) < 0)
    signals_ = Checked(signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK), "signalfd");
  if (fcntl(wakeups_, F_GETFD) < 0) wakeups_ = Checked(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd");
}

StopSignal::~StopSignal() {
  close(wakeups_);
  if (hears_ == Hears::kThreads) return;
  signalfd_siginfo unread;  // a pending signal would end this process once unblocked
  while (read(signals_, &unread, sizeof unread) == sizeof unread) {
  }
  close(signals_);
  const sigset_t set = Signals();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

int StopSignal::Within(std::chrono::nanoseconds timeout) {
  constexpr std::chrono::nanoseconds kLongestPause =
      std::chrono::milliseconds(500);  // descriptors may have been closed
  for (auto left = std::max(timeout, std::chrono::nanoseconds::zero());; left -= kLongestPause) {
    if (const int raised = raised_.exchange(0); raised != 0) return raised;
    pollfd fds[] = {{signals_, POLLIN, 0}, {wakeups_, POLLIN, 0}};
    const timespec limit{0, std::min(left, kLongestPause).count()};
    const int ready = ppoll(fds, 2, &limit, nullptr);
    if (ready > 0 && ((fds[0].revents | fds[1].revents) & POLLNVAL) != 0) {
      Open();
      ppoll(nullptr, 0, &limit, nullptr);
    }
    signalfd_siginfo info;
    if (ready > 0 && (fds[0].revents & POLLIN) != 0 && read(signals_, &info, sizeof info) == sizeof info)
      return info.ssi_signo == SIGCHLD ? 0 : static_cast<int>(info.ssi_signo);
    if (ready > 0 && (fds[1].revents & POLLIN) != 0) {
      eventfd_t count;
      eventfd_read(wakeups_, &count);
      woken_ = false;
      return raised_.exchange(0);
    }
    if (woken_.exchange(false) || ready < 0 || left <= kLongestPause) return raised_.exchange(0);
  }
}

void StopSignal::Raise(int signal) {
  raised_ = signal;
  Wake();
}

void StopSignal::Wake() {
  woken_ = true;
  eventfd_write(wakeups_, 1);
}

}  // namespace mascot
