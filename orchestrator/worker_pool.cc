#include "orchestrator/worker_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "orchestrator/process.h"

namespace mascot {
namespace {

constexpr std::size_t kLongest = std::size_t{64} << 10;  // of an answer or a failure
constexpr char kAnswer = 'a', kFailure = 'f';

[[noreturn]] void Fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::string WordsOf(const std::exception& error) {
  std::string words = error.what();
  if (words.size() > kLongest / 2) words.resize(kLongest / 2);
  return words;
}

/// A worker's own lines would only mix with others'; errors stay.
void SilenceOutput() {
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) ::dup2(nowhere, STDOUT_FILENO);
}

}  // namespace

WorkerPool::WorkerPool(int workers, Work work) : work_(std::move(work)) {
  for (int i = 0; i < workers; ++i) workers_.push_back(Fork());
}

WorkerPool::~WorkerPool() {
  for (Worker& worker : workers_) {
    ::kill(worker.pid, SIGKILL);
    Bury(worker);
  }
}

WorkerPool::Worker WorkerPool::Fork() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) Fail("socketpair");
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) Fail("fork");
  if (pid == 0) {
    ::setpgid(0, 0);  // Ctrl-C is the parent's business
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    for (const Worker& other : workers_) ::close(other.socket);
    ::close(ends[0]);
    SilenceOutput();
    Serve(ends[1]);
  }
  ::close(ends[1]);
  return {pid, ends[0], std::nullopt};
}

void WorkerPool::Serve(int socket) const {
  std::size_t task = 0;
  while (::recv(socket, &task, sizeof task, 0) == sizeof task) {
    std::string reply;
    try {
      reply = kAnswer + work_(task);
      if (reply.size() > kLongest) throw std::length_error("an answer of " + std::to_string(reply.size()) + " bytes");
    } catch (const std::exception& error) {
      reply = kFailure + WordsOf(error);
    }
    if (::send(socket, reply.data(), reply.size(), MSG_NOSIGNAL) < 0) break;
  }
  ::_exit(0);
}

bool WorkerPool::HasIdle() const {
  return std::ranges::any_of(workers_, [](const Worker& worker) { return !worker.task; });
}

bool WorkerPool::IsBusy() const {
  return std::ranges::any_of(workers_, [](const Worker& worker) { return worker.task.has_value(); });
}

void WorkerPool::Start(std::size_t task) {
  Worker& worker = *std::ranges::find_if(workers_, [](const Worker& each) { return !each.task; });
  worker.task = task;
  // One that died meanwhile is noticed by Wait, as the end of its socket.
  if (::send(worker.socket, &task, sizeof task, MSG_NOSIGNAL) < 0 && errno != EPIPE && errno != ECONNRESET)
    Fail("send to a worker");
}

std::optional<WorkerPool::Done> WorkerPool::Wait(std::chrono::milliseconds timeout) {
  std::vector<pollfd> sockets;
  for (const Worker& worker : workers_) sockets.push_back({worker.socket, POLLIN, 0});
  if (::poll(sockets.data(), sockets.size(), static_cast<int>(timeout.count())) <= 0) return std::nullopt;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    if (sockets[i].revents == 0) continue;
    Worker& worker = workers_[i];
    std::string reply(kLongest + 1, '\0');
    const ssize_t got = ::recv(worker.socket, reply.data(), reply.size(), 0);
    if (got > 0) {
      reply.resize(static_cast<std::size_t>(got));
      Done done{worker.task.value(), reply.substr(1), ""};
      if (reply[0] == kFailure) std::swap(done.answer, done.failure);
      worker.task.reset();
      return done;
    }
    const std::optional<std::size_t> task = worker.task;
    const std::string how = Bury(worker);
    worker = Fork();
    if (task) return Done{*task, "", std::string(kLostProcess) + how};
  }
  return std::nullopt;
}

std::string WorkerPool::Bury(Worker& worker) const {
  ::close(worker.socket);
  int status = 0;
  while (::waitpid(worker.pid, &status, 0) < 0 && errno == EINTR) {
  }
  return Exit{"", status}.Text();
}

}  // namespace mascot
