#include "orchestrator/live/run_socket.h"

#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <set>
#include <stdexcept>
#include <utility>

#include "orchestrator/live/compact_json.h"
#include "orchestrator/live/wish.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kName = "mascot-run-";  // and the process id
constexpr std::size_t kLongestLine = 1 << 20;
/// How long the other side may take for a line. A run may take a while for its answer: its laws may be slow.
constexpr int kClientSeconds = 2, kRunSeconds = 60;

std::string NameOf(pid_t process) { return std::string(kName) + std::to_string(process); }

/// Passes lines to and fro.
class Connection {
 public:
  /// `seconds`: how long the other side may take for a line.
  Connection(Descriptor socket, int seconds) : socket_(std::move(socket)) {
    const timeval limit{.tv_sec = seconds, .tv_usec = 0};
    ::setsockopt(socket_.number(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    ::setsockopt(socket_.number(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  }

  std::optional<ucred> Peer() const { return PeerOf(socket_); }

  bool Write(std::string line) const {
    line += '\n';
    for (std::size_t sent = 0; sent < line.size();) {
      const ssize_t count = ::send(socket_.number(), line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      sent += static_cast<std::size_t>(count);
    }
    return true;
  }

  /// A line; nothing if none comes, whole and in time.
  std::optional<std::string> Read() const {
    std::string line;
    std::array<char, 4096> buffer{};
    while (line.size() <= kLongestLine) {
      const ssize_t count = ::recv(socket_.number(), buffer.data(), buffer.size(), 0);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return std::nullopt;
      line.append(buffer.data(), static_cast<std::size_t>(count));
      if (const auto end = line.find('\n'); end != std::string::npos) return line.substr(0, end);
    }
    return std::nullopt;
  }

 private:
  Descriptor socket_;
};

/// Whether user `asking` may ask a process of user `asked`.
bool MayAsk(uid_t asking, uid_t asked) { return asking == asked || asking == 0; }

std::string AnswerJson(const Answer& answer) {
  return CompactJson({{"granted", answer.granted}, {"words", answer.words}});
}

/// Sends a line to a run, and returns its answer.
std::optional<Json> ExchangeLines(pid_t process, const Json& request, ucred* peer = nullptr) {
  Descriptor socket = MakeLocalSocket(SOCK_CLOEXEC);
  if (!ConnectTo(NameOf(process), socket)) return std::nullopt;
  const Connection run(std::move(socket), kRunSeconds);
  const auto who = run.Peer();
  if (who && peer != nullptr) *peer = *who;
  if (!who || !run.Write(CompactJson(request))) return std::nullopt;
  const auto line = run.Read();
  const Json answer = line ? Json::parse(*line, nullptr, /*allow_exceptions=*/false) : Json();
  return answer.is_object() ? std::optional(answer) : std::nullopt;
}

/// The process ids in the names of all sockets that look like those of runs.
std::set<pid_t> NamesInUse() {
  std::set<pid_t> processes;
  std::ifstream table("/proc/net/unix");
  for (std::string line; std::getline(table, line);) {
    const auto at = line.rfind('@');
    if (at == std::string::npos || line.compare(at + 1, kName.size(), kName) != 0) continue;
    pid_t process = 0;
    const char *begin = line.data() + at + 1 + kName.size(), *end = line.data() + line.size();
    if (std::from_chars(begin, end, process).ptr == end) processes.insert(process);
  }
  return processes;
}

}  // namespace

RunSocket::RunSocket(const Experiment& experiment, const std::string& folder, const std::string& engine,
                     const std::string& page, Helm& helm)
    : experiment_(experiment),
      folder_(folder),
      engine_(engine),
      page_(page),
      helm_(helm),
      socket_(MakeLocalSocket(SOCK_CLOEXEC)) {
  if (!ListenAs(NameOf(::getpid()), socket_))
    throw std::runtime_error(std::string("cannot make the socket by which `orchestrator send` reaches this run: ") +
                             std::strerror(errno));
  thread_ = std::jthread([this] { Listen(); });
}

RunSocket::~RunSocket() {
  ::shutdown(socket_.number(), SHUT_RDWR);  // Listen() sees it, and returns
}

void RunSocket::Listen() {
  for (;;) {
    Descriptor client(::accept4(socket_.number(), nullptr, nullptr, SOCK_CLOEXEC));
    if (client.is_open())
      Serve(std::move(client));
    else if (errno == EINVAL)
      return;
  }
}

void RunSocket::Serve(Descriptor client) {
  const Connection connection(std::move(client), kClientSeconds);
  const auto peer = connection.Peer();
  const auto request = connection.Read();  // first: who closes with something unread takes back what it said
  if (!peer || !request) return;
  connection.Write(MayAsk(peer->uid, ::geteuid())
                       ? AnswerTo(*request)
                       : AnswerJson({false, "this run is user " + UserName(::geteuid()) + "'s"}));
}

std::string RunSocket::AnswerTo(const std::string& line) {
  const Json request = Json::parse(line, nullptr, /*allow_exceptions=*/false);
  if (request.is_object() && request.contains("who")) {
    const Going going = helm_.going();
    return CompactJson({{"name", experiment_.run.name},
                        {"folder", folder_},
                        {"engine", engine_},
                        {"page", page_},
                        {"agents", experiment_.size()},
                        {"domain", going.domain},
                        {"tick", going.tick},
                        {"t_s", experiment_.time_s(std::max<std::int64_t>(going.tick, 0))},
                        {"duration_s", experiment_.run.duration_s},
                        {"paused", going.paused},
                        {"pace", going.pace}});
  }
  try {
    return AnswerJson(helm_.Ask(ReadWish(request)));
  } catch (const std::exception& error) {
    return AnswerJson({false, error.what()});
  }
}

std::vector<RunningRun> RunsAlive() {
  std::vector<RunningRun> runs;
  for (const pid_t process : NamesInUse()) {
    ucred peer{};
    const auto answer = ExchangeLines(process, {{"who", true}}, &peer);
    if (!answer || peer.pid != process) continue;
    RunningRun run;
    run.process = process;
    run.user = UserName(peer.uid);
    run.is_ours = answer->contains("folder");
    if (run.is_ours) {
      answer->at("name").get_to(run.name);
      answer->at("folder").get_to(run.folder);
      answer->at("engine").get_to(run.engine);
      answer->at("page").get_to(run.page);
      answer->at("agents").get_to(run.agents);
      answer->at("domain").get_to(run.domain);
      answer->at("tick").get_to(run.tick);
      answer->at("t_s").get_to(run.t_s);
      answer->at("duration_s").get_to(run.duration_s);
      answer->at("paused").get_to(run.paused);
      answer->at("pace").get_to(run.pace);
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

std::string RunsJson(const std::vector<RunningRun>& runs) {
  Json list = Json::array();
  for (const RunningRun& run : runs) {
    Json json{{"process", run.process}, {"user", run.user}};
    if (run.is_ours)
      json.update({{"name", run.name},
                   {"folder", run.folder},
                   {"engine", run.engine},
                   {"page", run.page.empty() ? Json() : Json(run.page)},
                   {"domain", run.domain < 0 ? Json() : Json(run.domain)},
                   {"agents", run.agents},
                   {"tick", run.tick < 0 ? Json() : Json(run.tick)},
                   {"t_s", run.t_s},
                   {"duration_s", run.duration_s},
                   {"paused", run.paused},
                   {"pace", run.pace}});
    list.push_back(std::move(json));
  }
  return list.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::optional<Answer> AskRun(pid_t process, const Wish& wish) {
  const auto answer = ExchangeLines(process, WishJson(wish));
  if (!answer || !answer->contains("granted") || !answer->contains("words")) return std::nullopt;
  return Answer{answer->at("granted").get<bool>(), answer->at("words").get<std::string>()};
}

}  // namespace mascot
