// Lower bound set by the operating system: the same lockstep over Unix sockets, with one message to each agent process
// and one back, without DDS. They are as large as in a ring.
//   socket_exchange AGENTS SECONDS [AGENTS-PER-PROCESS]     prints one line of JSON: ticks per second
#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using WallClock = std::chrono::steady_clock;

constexpr std::size_t kStateBytes = 152, kCommandBytes = 104;  // as bodies in bundles

/// A sample begins with its tick; the rest is only its size.
using Sample = std::vector<std::uint64_t>;
Sample SampleOf(std::size_t bytes) { return Sample(1 + bytes / sizeof(std::uint64_t)); }
std::size_t BytesOf(const Sample& sample) { return sample.size() * sizeof(std::uint64_t); }
bool Send(int socket, const Sample& sample) { return send(socket, sample.data(), BytesOf(sample), MSG_NOSIGNAL) > 0; }
bool Receive(int socket, Sample& sample) {
  return recv(socket, sample.data(), BytesOf(sample), 0) == static_cast<ssize_t>(BytesOf(sample));
}

[[noreturn]] void RunAgents(int socket, Sample states, Sample answer) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  while (Receive(socket, states)) {
    answer[0] = states[0];
    if (!Send(socket, answer)) break;
  }
  _exit(0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fprintf(stderr, "usage: socket_exchange AGENTS SECONDS [AGENTS-PER-PROCESS]\n");
    return 2;
  }
  const int agents = std::atoi(argv[1]), share = argc == 4 ? std::atoi(argv[3]) : 1;
  if (agents < 1 || share < 1) return 2;
  const int processes = (agents + share - 1) / share;
  const auto heard = static_cast<std::size_t>(std::min(agents, share + 2));
  Sample states = SampleOf(kStateBytes * heard), answer = SampleOf(kCommandBytes * static_cast<std::size_t>(share));
  const int poll_fd = epoll_create1(0);
  std::vector<int> sockets;
  std::vector<pid_t> pids;
  for (int i = 0; i < processes; ++i) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) != 0) return 1;
    const pid_t pid = fork();
    if (pid == 0) {
      close(ends[0]);
      RunAgents(ends[1], states, answer);
    }
    close(ends[1]);
    epoll_event event{EPOLLIN, {.fd = ends[0]}};
    epoll_ctl(poll_fd, EPOLL_CTL_ADD, ends[0], &event);
    sockets.push_back(ends[0]);
    pids.push_back(pid);
  }
  std::vector<epoll_event> events(static_cast<std::size_t>(processes));
  const auto start = WallClock::now();
  const std::chrono::duration<double> limit(std::atof(argv[2]));
  while (WallClock::now() - start < limit) {
    ++states[0];
    for (const int socket : sockets)
      if (!Send(socket, states)) return 1;
    for (int missing = processes; missing > 0;) {
      const int ready = epoll_wait(poll_fd, events.data(), processes, -1);
      for (int k = 0; k < ready; ++k) missing -= Receive(events[static_cast<std::size_t>(k)].data.fd, answer) ? 1 : 0;
    }
  }
  const std::chrono::duration<double> wall = WallClock::now() - start;
  std::printf("{\"ticks_per_s\": %.1f}\n", static_cast<double>(states[0]) / wall.count());
  for (const pid_t pid : pids) {
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
  return 0;
}
