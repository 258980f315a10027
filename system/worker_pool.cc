#include "system/worker_pool.h"

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
#include <utility>

#include "system/children.h"

namespace mascot {
namespace {

constexpr char kAnswer = 'a', kFailure = 'f';

[[noreturn]] void Fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

// Reply of a worker: its length (std::size_t), then as many bytes: kAnswer or kFailure, then the text.

bool SendReply(int socket, const std::string& reply) {
  const std::size_t size = reply.size();
  std::string message(reinterpret_cast<const char*>(&size), sizeof size);
  message += reply;
  for (std::size_t done = 0; done < message.size();) {
    const ssize_t sent = ::send(socket, message.data() + done, message.size() - done, MSG_NOSIGNAL);
    if (sent < 0 && errno != EINTR) return false;
    done += static_cast<std::size_t>(std::max<ssize_t>(sent, 0));
  }
  return true;
}

bool Receive(int socket, void* data, std::size_t size) {
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = ::recv(socket, static_cast<char*>(data) + done, size - done, 0);
    if (got == 0 || (got < 0 && errno != EINTR)) return false;
    done += static_cast<std::size_t>(std::max<ssize_t>(got, 0));
  }
  return true;
}

/// Receives a reply; nothing if the worker has ended.
std::optional<std::string> ReceiveReply(int socket) {
  std::size_t size = 0;
  if (!Receive(socket, &size, sizeof size)) return std::nullopt;
  std::string reply(size, '\0');
  if (!Receive(socket, reply.data(), size)) return std::nullopt;
  return reply;
}

/// Sends stdout to /dev/null: the lines of several workers would be mixed. stderr stays.
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
    SignalProcess(worker.pid, SIGKILL);
    Reap(worker);
  }
}

WorkerPool::Worker WorkerPool::Fork() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) Fail("socketpair");
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) Fail("fork");
  if (pid == 0) {
    ::setpgid(0, 0);  // Ctrl-C must reach the parent only
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    for (const Worker& other : workers_)
      if (other.socket >= 0) ::close(other.socket);
    ::close(ends[0]);
    SilenceOutput();
    Serve(ends[1]);
  }
  ::close(ends[1]);
  return {pid, ends[0], std::nullopt};
}

void WorkerPool::Serve(int socket) const {
  std::size_t task = 0;
  while (Receive(socket, &task, sizeof task)) {
    std::string reply;
    try {
      reply = kAnswer + work_(task);
    } catch (const std::exception& error) {
      reply = kFailure + std::string(error.what());
    }
    if (!SendReply(socket, reply)) break;
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
  // If the worker has died meanwhile, Wait notices the closed socket.
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
    if (const auto reply = ReceiveReply(worker.socket)) {
      Done done{worker.task.value(), reply->substr(1), ""};
      if (reply->front() == kFailure) std::swap(done.answer, done.failure);
      worker.task.reset();
      return done;
    }
    const std::optional<std::size_t> task = worker.task;
    const std::string exit_text = Reap(worker);
    worker = Fork();
    if (task) return Done{*task, "", std::string(kLostProcess) + exit_text};
  }
  return std::nullopt;
}

std::string WorkerPool::Reap(Worker& worker) const {
  const pid_t process = std::exchange(worker.pid, 0);
  if (process <= 0) return "";  // it could not be forked again
  ::close(std::exchange(worker.socket, -1));
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return Exit{"", status}.Text();
}

}  // namespace mascot
