// Lower bound set by the operating system: the same lockstep over Unix sockets, with one message to each agent process
// and one back, without DDS.
//   socket_exchange AGENTS SECONDS     prints one line of JSON: ticks per second
#include <poll.h>
#include <signal.h>
#include <sys/epoll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using WallClock = std::chrono::steady_clock;

struct States {  // what an agent of a ring hears: three states of 168 bytes
  std::uint64_t tick;
  std::array<char, 496> rest;
};
struct Answer {  // a command
  std::uint64_t tick;
  std::array<char, 100> rest;
};

[[noreturn]] void RunAgent(int socket) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  States states;
  Answer answer{};
  while (recv(socket, &states, sizeof states, 0) == sizeof states) {
    answer.tick = states.tick;
    if (send(socket, &answer, sizeof answer, MSG_NOSIGNAL) < 0) break;
  }
  _exit(0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: socket_exchange AGENTS SECONDS\n");
    return 2;
  }
  const int agents = std::atoi(argv[1]);
  const int poll_fd = epoll_create1(0);
  std::vector<int> sockets;
  std::vector<pid_t> pids;
  for (int i = 0; i < agents; ++i) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) != 0) return 1;
    const pid_t pid = fork();
    if (pid == 0) {
      close(ends[0]);
      RunAgent(ends[1]);
    }
    close(ends[1]);
    epoll_event event{EPOLLIN, {.fd = ends[0]}};
    epoll_ctl(poll_fd, EPOLL_CTL_ADD, ends[0], &event);
    sockets.push_back(ends[0]);
    pids.push_back(pid);
  }
  States states{};
  Answer answer;
  std::vector<epoll_event> events(static_cast<std::size_t>(agents));
  const auto start = WallClock::now();
  const std::chrono::duration<double> limit(std::atof(argv[2]));
  while (WallClock::now() - start < limit) {
    ++states.tick;
    for (const int socket : sockets)
      if (send(socket, &states, sizeof states, 0) < 0) return 1;
    for (int missing = agents; missing > 0;) {
      const int ready = epoll_wait(poll_fd, events.data(), agents, -1);
      for (int k = 0; k < ready; ++k)
        missing -= recv(events[static_cast<std::size_t>(k)].data.fd, &answer, sizeof answer, 0) == sizeof answer;
    }
  }
  const std::chrono::duration<double> wall = WallClock::now() - start;
  std::printf("{\"ticks_per_s\": %.1f}\n", static_cast<double>(states.tick) / wall.count());
  for (const pid_t pid : pids) {
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
  return 0;
}
