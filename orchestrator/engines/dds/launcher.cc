#include "orchestrator/engines/dds/launcher.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "bus/local_socket.h"
#include "experiment/toml/utf8.h"
#include "orchestrator/engines/dds/route.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/processes/build.h"
#include "orchestrator/processes/line_pipe.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

constexpr std::size_t kLongestQuote = 200;
constexpr double kShareOfStart = 0.9;  // of run.start_timeout_s, for a host to answer: its agents join after that
constexpr int kMostLines = 10'000;     // read of a connection at once: the run must go on beside one that floods

/// What a host said, for a message.
std::string Quote(const std::string& text) { return std::string(CutUtf8(PlainLine(text), kLongestQuote)); }

std::pair<Descriptor, Descriptor> Pipe() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

}  // namespace

/// A launch command that runs.
struct Launcher::Connection {
  Connection(std::string process, Descriptor from, Descriptor to)
      : name(std::move(process)),
        from_hosts(std::move(from)),
        to_hosts(std::move(to)),
        input(from_hosts.number()),
        output(to_hosts.number()) {}
  /// The next line of its hosts, if there is one. Throws std::runtime_error, naming the connection, for one without
  /// end.
  std::optional<std::string> Next() try { return input.Next(); } catch (const std::runtime_error& failure) {
    throw std::runtime_error(name + ": " + failure.what());
  }

  std::string name;
  Descriptor from_hosts, to_hosts;
  LineReader input;
  LineWriter output;
};

/// A host.
struct Launcher::Remote {
  /// The log of a process of this host. Throws std::runtime_error if it has no such process.
  Descriptor& LogOf(const std::string& process) {
    const auto log = logs.find(process);
    if (log != logs.end()) return log->second;
    throw std::runtime_error(
        fmt::format("host {}: expected words of its own processes, got {}", config.name, Quote(process)));
  }

  const HostConfig& config;
  Connection& connection;
  Time heard = WallClock::now();
  bool greeted = false;
  std::string machine = {};                     // as it says itself
  std::map<std::string, Descriptor> logs = {};  // of its processes, until they end: their lines go there
  std::map<std::string, int> pids = {};         // to be compared with who joins the run
};

Launcher::Launcher(const Experiment& experiment, const RunFolder& folder, Rules rules, Children& children,
                   ChildLogs& logs, Peers& peers)
    : experiment_(experiment),
      folder_(folder),
      rules_(std::move(rules)),
      children_(children),
      logs_(logs),
      peers_(peers) {}

Launcher::~Launcher() = default;

/// Starts the launch command of a host.
Launcher::Connection& Launcher::Connect(const HostConfig& host) {
  auto [input, to_host] = Pipe();
  auto [from_host, output] = Pipe();
  std::vector<std::string> words(host.launch.begin() + 1, host.launch.end());
  const std::string ours = (ProgramFolder() / "orchestrator").string();
  words.insert(words.end(), {host.program.empty() ? ours : host.program, "host"});
  const std::string process = host.together ? "hosts" : "host_" + host.name;
  children_.Spawn(process, host.launch.front(), words, folder_.Log(process), {input.number(), output.number()});
  connections_.push_back(std::make_unique<Connection>(process, std::move(from_host), std::move(to_host)));
  return *connections_.back();
}

void Launcher::Start() {
  Connection* of_all = nullptr;
  for (const HostConfig& host : experiment_.hosts) {
    Connection& connection = host.together && of_all != nullptr ? *of_all : Connect(host);
    if (host.together) of_all = &connection;
    remotes_.push_back(std::make_unique<Remote>(Remote{.config = host, .connection = connection}));
  }
}

bool Launcher::Pump() {
  const auto now = WallClock::now();
  bool told = false;
  if (now > next_sign_) {
    next_sign_ = now + kBetweenSigns;
    TellAll({{"kind", "alive"}});
  }
  for (const auto& connection : connections_)
    for (int lines = 0; lines < kMostLines; ++lines) {
      const auto line = connection->Next();
      if (!line) break;
      told = true;
      Hear(*connection, *line);
    }
  for (const auto& remote : remotes_) {
    CheckPids(*remote);
    CheckSilence(*remote);
  }
  return told;
}

/// Throws std::runtime_error if nothing was heard of a host for too long.
void Launcher::CheckSilence(const Remote& remote) const {
  if (ending_) return;
  const std::chrono::duration<double> silence = WallClock::now() - remote.heard;
  const double limit_s = remote.greeted ? rules_.silence_s : kShareOfStart * rules_.start_timeout_s;
  if (silence.count() <= limit_s) return;
  throw std::runtime_error(
      remote.greeted
          ? fmt::format("host {} has not been heard of for {:.3g} s", remote.config.name, limit_s)
          : fmt::format("host {} has not answered for {:.3g} s (does its launch command ask for a password?)",
                        remote.config.name, limit_s));
}

/// Throws std::runtime_error for what is no word of a host of this run.
void Launcher::Hear(const Connection& connection, const std::string& line) {
  const auto is_here = [&](const auto& remote) { return &remote->connection == &connection; };
  const std::string name = (*std::ranges::find_if(remotes_, is_here))->config.name;
  const auto words = JsonOrNull<nlohmann::json>(line);
  if (!words.is_object() || !words.contains("kind"))
    throw std::runtime_error(
        fmt::format("host {}: expected the words of `orchestrator host`, got '{}' (does its login "
                    "print something?)",
                    name, Quote(line)));
  try {
    const std::string node = words.value("node", "");
    const auto speaks = [&](const auto& remote) {
      return is_here(remote) && (!remote->config.together || remote->config.name == node);
    };
    const auto remote = std::ranges::find_if(remotes_, speaks);
    if (remote == remotes_.end())
      throw std::runtime_error(fmt::format("host {}: expected hosts of the run, got {}", name, Quote(node)));
    Obey(**remote, words);
  } catch (const nlohmann::json::exception& mistake) {
    throw std::runtime_error(fmt::format("host {}: {}", name, mistake.what()));
  }
}

void Launcher::Obey(Remote& remote, const nlohmann::json& words) {
  remote.heard = WallClock::now();
  const std::string kind = words["kind"];
  if (kind == "error")
    throw std::runtime_error(
        fmt::format("host {}: {}", remote.config.name, Quote(words.at("text").get<std::string>())));
  if ((kind == "hello") == remote.greeted)
    throw std::runtime_error(
        fmt::format("host {}: expected its greeting first, and once, got '{}'", remote.config.name, Quote(kind)));
  if (kind == "hello") Greet(remote, words.get<HostHello>());
  if (!words.contains("process")) return;
  const std::string process = words["process"];
  Descriptor& log = remote.LogOf(process);
  if (kind == "started") remote.pids[process] = words.at("pid");
  if (kind == "line" && log.is_open()) {
    const std::string text = words.at("text").get<std::string>() + (words.at("more") ? "" : "\n");
    if (write(log.number(), text.data(), text.size()) < 0) log = Descriptor();
  }
  if (kind == "exit") {
    log = Descriptor();
    exits_.push_back({process, words.at("status")});
  }
}

/// Checks the other side, and tells it what to do.
void Launcher::Greet(Remote& remote, const HostHello& hello) {
  const HostConfig& host = remote.config;
  if (hello.build != BuildText())
    throw std::runtime_error(fmt::format("host {} has another build of MASCOT: {}, expected {}", host.name,
                                         Quote(hello.build), BuildText()));
  for (const auto& other : remotes_)
    if (other->greeted && other->machine == hello.machine && hello.machine != MachineText())
      throw std::runtime_error(
          fmt::format("hosts {} and {} are one machine: expected each machine once", other->config.name, host.name));
  HostJob job = rules_.job(host, OurAddress(host, hello.seen_from));
  job.own_memory = hello.machine != MachineText();
  for (const HostProcess& process : job.processes)
    remote.logs.emplace(process.name, Descriptor(logs_.Open(process.name, folder_.Log(process.name))));
  nlohmann::json words = job;
  words["kind"] = "job";
  if (host.together) words["node"] = host.name;
  remote.connection.output.Write(words.dump());
  remote.machine = hello.machine;
  remote.greeted = true;
}

/// Throws std::runtime_error if who joined as a process of this host is none that it has started.
void Launcher::CheckPids(const Remote& remote) const {
  if (remote.pids.empty()) return;
  for (const auto& [process, key] : peers_.Places()) {
    const auto pid = remote.pids.find(process);
    if (pid != remote.pids.end() && key.IsExact() && !ProcessKey::WithPid(pid->second).Fits(key))
      throw std::runtime_error(
          fmt::format("{} is not the process that host {} has started", process, remote.config.name));
  }
}

std::vector<Exit> Launcher::Reap() { return std::exchange(exits_, {}); }

void Launcher::TellAll(const nlohmann::json& words) {
  for (const auto& connection : connections_) connection->output.Write(words.dump());
}

void Launcher::Kill() { TellAll({{"kind", "kill"}}); }

bool Launcher::End() {
  ending_ = true;
  TellAll({{"kind", "end"}});
  return std::ranges::any_of(remotes_, [](const auto& remote) { return remote->greeted; });
}

}  // namespace mascot
