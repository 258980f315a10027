#include "system/worker_pool.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "system/spawn.h"

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
  for (int i = 0; i < workers; ++i) workers_.push_back(StartWorker());
}

WorkerPool::Worker WorkerPool::StartWorker() const {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) Fail("cannot make a pair of sockets");
  Descriptor ours(ends[0]);
  const Descriptor theirs(ends[1]);
  ChildProcess process = Fork([&] {
    for (const Worker& other : workers_)
      if (other.socket.is_open()) ::close(other.socket.number());
    ::close(ours.number());
    SilenceOutput();
    Serve(theirs.number());
  });
  return {.process = std::move(process), .socket = std::move(ours)};
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
    if (!SendReply(socket, reply)) return;
  }
}

bool WorkerPool::HasIdle() const {
  return std::ranges::any_of(workers_, [](const Worker& worker) { return !worker.task; });
}

bool WorkerPool::IsBusy() const {
  return std::ranges::any_of(workers_, [](const Worker& worker) { return worker.task.has_value(); });
}

void WorkerPool::Start(std::size_t task) {
  Worker& worker = *std::ranges::find_if(workers_, [](const Worker& each) { return !each.task; });
  if (worker.process.number() == 0) worker = StartWorker();
  // If the worker has died meanwhile, Wait notices the closed socket.
  if (::send(worker.socket.number(), &task, sizeof task, MSG_NOSIGNAL) < 0 && errno != EPIPE && errno != ECONNRESET)
    Fail("send to a worker");
  worker.task = task;
}

std::optional<WorkerPool::Done> WorkerPool::Wait(std::chrono::milliseconds timeout) {
  std::vector<pollfd> sockets;
  for (const Worker& worker : workers_) sockets.push_back({worker.socket.number(), POLLIN, 0});  // -1 is passed over
  if (::poll(sockets.data(), sockets.size(), static_cast<int>(timeout.count())) <= 0) return std::nullopt;
  for (std::size_t i = 0; i < workers_.size(); ++i) {
    if (sockets[i].revents == 0) continue;
    Worker& worker = workers_[i];
    if (const auto reply = ReceiveReply(worker.socket.number())) {
      Done done{worker.task.value(), reply->substr(1), ""};
      if (reply->front() == kFailure) std::swap(done.answer, done.failure);
      worker.task.reset();
      return done;
    }
    Worker lost = std::exchange(worker, Worker{.process = ChildProcess(), .socket = Descriptor()});
    const int status = lost.process.Reap().value_or(kUnknownEnd);
    if (lost.task) return Done{*lost.task, "", std::string(kLostProcess) + EndText(status)};
  }
  return std::nullopt;
}

}  // namespace mascot
