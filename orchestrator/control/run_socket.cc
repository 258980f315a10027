#include "orchestrator/control/run_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <random>
#include <stdexcept>
#include <utility>

#include "orchestrator/control/local_lines.h"
#include "orchestrator/control/request.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;

/// How long a client may take to ask, and to take its answer.
constexpr auto kClientLimit = 2s;
constexpr int kRoomPause_ms = 100, kLookPause_ms = 500;

LocalLines::Time ClientDeadline() { return std::chrono::steady_clock::now() + kClientLimit; }

void Listen(const Descriptor& socket) {
  std::string name = std::string(kRunSocketPrefix) + std::to_string(::getpid());
  if (ListenAs(name, socket)) return;
  // Any user can take the names of runs to come, but not all the names that this may be.
  name += "-" + std::to_string(std::random_device()());
  if (errno == EADDRINUSE && ListenAs(name, socket)) return;
  throw std::runtime_error(std::string("cannot make the socket by which `orchestrator send` reaches this run: ") +
                           std::strerror(errno));
}

std::string AnswerJson(const Answer& answer) {
  return CompactJson({{"granted", answer.granted}, {"words", answer.words}});
}

}  // namespace

RunSocket::RunSocket(const Experiment& experiment, const std::string& folder, const std::string& engine,
                     const std::string& page, RunRequests& requests)
    : experiment_(experiment),
      folder_(folder),
      engine_(engine),
      page_(page),
      requests_(requests),
      socket_(MakeLocalSocket(SOCK_CLOEXEC | SOCK_NONBLOCK)),
      request_queue_(requests) {
  mascot::Listen(socket_);
  thread_ = std::jthread([this](const std::stop_token& over) { Listen(over); });
}

RunSocket::~RunSocket() {
  thread_.request_stop();
  ::shutdown(socket_.number(), SHUT_RDWR);  // Listen() sees it, and returns
}

void RunSocket::Listen(const std::stop_token& over) {
  while (!over.stop_requested()) {
    pollfd socket{socket_.number(), POLLIN, 0};
    const int ready = ::poll(&socket, 1, kLookPause_ms);
    if (ready < 0 && errno != EINTR) ::poll(nullptr, 0, kRoomPause_ms);  // the limit of descriptors is below 1
    if (ready <= 0) continue;
    if ((socket.revents & POLLNVAL) != 0) return;  // a law has closed it
    Descriptor client(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (client.is_open()) {
      const auto peer = PeerOf(client);
      if (peer && IsTrusted(*peer)) Serve(std::move(client));
    } else if (HasNoRoom(errno)) {
      ::poll(nullptr, 0, kRoomPause_ms);
    } else if (errno == EINVAL || errno == EBADF || errno == ENOTSOCK) {
      return;
    }
  }
}

void RunSocket::Serve(Descriptor client) {
  const auto lines = std::make_shared<LocalLines>(std::move(client));
  std::string line;
  if (lines->Read(ClientDeadline(), line) != LocalLines::End::kLine) return;
  const auto answer = [lines](const Answer& given) { lines->Write(AnswerJson(given), ClientDeadline()); };
  try {
    const auto request = ObjectOrNothing(line);
    if (!request) throw std::invalid_argument("expected a JSON object");
    if (request->contains("who"))
      lines->Write(WhoWeAre(), ClientDeadline());
    else
      request_queue_.Ask(ReadRequest(*request), answer);
  } catch (const std::exception& error) {
    answer({false, error.what()});
  }
}

std::string RunSocket::WhoWeAre() const {
  const RunStatus status = requests_.status();
  return CompactJson({{"name", experiment_.run.name},
                      {"folder", folder_},
                      {"engine", engine_},
                      {"page", page_},
                      {"agents", experiment_.size()},
                      {"domain", status.domain},
                      {"tick", status.tick},
                      {"t_s", experiment_.time_s(std::max<std::int64_t>(status.tick, 0))},
                      {"duration_s", experiment_.run.duration_s},
                      {"paused", status.paused},
                      {"pace", status.pace},
                      {"vehicles", status.vehicles}});
}

}  // namespace mascot
