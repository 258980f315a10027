#include "orchestrator/engines/dds/hosts/launcher.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>
#include <stdexcept>
#include <utility>

#include "base/utf8.h"
#include "orchestrator/engines/dds/hosts/route.h"
#include "orchestrator/engines/dds/hosts/same_bits.h"
#include "orchestrator/formats/compact_json.h"
#include "orchestrator/formats/outside_fields.h"
#include "orchestrator/formats/outside_json.h"
#include "system/build.h"
#include "system/descriptor.h"
#include "system/line_pipe.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

constexpr std::size_t kLongestQuote = 200, kLongestName = 1000, kLongestText = 10'000;
constexpr int kMaxPid = 1 << 22, kMaxStatus = 0xffff;  // of Linux; of waitpid(2)
constexpr double kShareOfStart = 0.9;  // of run.start_timeout_s, for a host to answer: its agents join after that
constexpr int kMaxLines = 10'000;      // read of a connection at once: the run must go on beside one that floods

/// What a host said, for a message.
std::string Quote(const std::string& text) { return std::string(CutUtf8(PlainLine(text), kLongestQuote)); }

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
  std::map<std::string, int> pids = {};         // to be compared with the participants that join the run
  std::set<std::string> ended = {};
  bool lost = false;
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
  auto [input, to_host] = MakePipe();
  auto [from_host, output] = MakePipe();
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
    for (int lines = 0; lines < kMaxLines; ++lines) {
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

/// A host of which nothing was heard for too long is lost. Throws std::runtime_error if the run does not go on.
void Launcher::CheckSilence(Remote& remote) {
  if (ending_ || remote.lost) return;
  const std::chrono::duration<double> silence = WallClock::now() - remote.heard;
  const double limit_s = remote.greeted ? rules_.silence_s : kShareOfStart * rules_.start_timeout_s;
  if (silence.count() <= limit_s) return;
  if (remote.greeted && rules_.goes_on()) {
    Lose(remote, fmt::format("which has not been heard of for {:.3g} s", limit_s));
    if (!remote.config.together) children_.Kill(remote.connection.name);  // if it hears that, it kills its processes
    return;
  }
  throw std::runtime_error(
      remote.greeted
          ? fmt::format("host {} has not been heard of for {:.3g} s", remote.config.name, limit_s)
          : fmt::format("host {} has not answered for {:.3g} s (does its launch command ask for a password?)",
                        remote.config.name, limit_s));
}

/// `how`: ends "was on host lab2, ...".
void Launcher::Lose(Remote& remote, const std::string& how) {
  remote.lost = true;
  for (auto& [process, log] : remote.logs) {
    log = Descriptor();
    if (remote.ended.insert(process).second)
      ended_.push_back({process, {}, fmt::format("was on host {}, {}", remote.config.name, how)});
  }
}

bool Launcher::OnExit(const Exit& exit) {
  const auto connection =
      std::ranges::find_if(connections_, [&](const auto& one) { return one->name == exit.process; });
  if (connection == connections_.end() || ending_ || !rules_.goes_on()) return false;
  for (const auto& remote : remotes_)
    if (&remote->connection == connection->get() && !remote->lost)
      Lose(*remote, "the connection to which " + exit.Text());
  return true;
}

std::vector<Launcher::Ended> Launcher::TakeEnded() { return std::exchange(ended_, {}); }

/// Throws std::runtime_error for what is no word of a host of this run.
void Launcher::Hear(const Connection& connection, const std::string& line) {
  const auto is_here = [&](const auto& remote) { return &remote->connection == &connection; };
  const std::string name = (*std::ranges::find_if(remotes_, is_here))->config.name;
  const auto words = ObjectOrNothing(line);
  if (!words || !words->contains("kind"))
    throw std::runtime_error(
        fmt::format("host {}: expected the words of `orchestrator host`, got '{}' (does its login "
                    "print something?)",
                    name, Quote(line)));
  try {
    OutsideFields fields(*words);
    const std::string node = fields.Has("node") ? fields.Text("node", kLongestName) : "";
    fields.Require();
    const auto speaks = [&](const auto& remote) {
      return is_here(remote) && (!remote->config.together || remote->config.name == node);
    };
    const auto remote = std::ranges::find_if(remotes_, speaks);
    if (remote == remotes_.end())
      throw std::runtime_error(fmt::format("host {}: expected hosts of the run, got {}", name, Quote(node)));
    if (!(*remote)->lost) Obey(**remote, *words);
  } catch (const JsonError& mistake) {
    throw std::runtime_error(fmt::format("host {}: {}", name, mistake.what()));
  }
}

void Launcher::Obey(Remote& remote, const HostWords& words) {
  remote.heard = WallClock::now();
  OutsideFields fields(words);
  const std::string kind = fields.Text("kind", kLongestName);
  fields.Require();
  if (kind == "error") {
    const std::string text = fields.Text("text", kLongestText);
    fields.Require();
    throw std::runtime_error(fmt::format("host {}: {}", remote.config.name, Quote(text)));
  }
  if ((kind == "hello") == remote.greeted)
    throw std::runtime_error(
        fmt::format("host {}: expected its greeting first, and once, got '{}'", remote.config.name, Quote(kind)));
  if (kind == "hello")
    Greet(remote, ReadHello(words));
  else if (kind == "started" || kind == "line" || kind == "exit")
    TakeWordOf(remote, kind, fields);
  else if (kind != "alive")
    throw std::runtime_error(
        fmt::format("host {}: expected the words of `orchestrator host`, got '{}'", remote.config.name, Quote(kind)));
}

/// Takes what a host tells of one of its processes.
void Launcher::TakeWordOf(Remote& remote, const std::string& kind, OutsideFields& fields) {
  const std::string process = fields.Text("process", kLongestName);
  fields.Require();
  Descriptor& log = remote.LogOf(process);
  const auto refuse_repetition = [&](bool is_repeated) {
    if (is_repeated)
      throw std::runtime_error(
          fmt::format("host {}: expected \"{}\" of {} once, got it again", remote.config.name, kind, process));
  };
  if (kind == "started") {
    const auto pid = static_cast<int>(fields.Integer("pid", 1, kMaxPid));
    fields.Require();
    refuse_repetition(!remote.pids.emplace(process, pid).second);
  } else if (kind == "line") {
    std::string text = fields.Text("text", kLongestText);
    if (!fields.Boolean("more")) text += '\n';
    fields.Require();
    if (log.is_open() && write(log.number(), text.data(), text.size()) != std::ssize(text))
      throw std::runtime_error("cannot pass on what " + process + " prints: " + std::strerror(errno));
  } else {
    const auto status = static_cast<int>(fields.Integer("status", 0, kMaxStatus));
    fields.Require();
    if (!WIFEXITED(status) && !WIFSIGNALED(status))
      throw JsonError(fmt::format("expected how {} has ended as \"status\", got {}", process, status));
    refuse_repetition(!remote.ended.insert(process).second);
    log = Descriptor();
    const Exit exit{process, status};
    ended_.push_back({process, exit.code(), exit.Text() + " on " + remote.config.name});
  }
}

/// Checks the other side, and tells it what to do.
void Launcher::Greet(Remote& remote, const HostHello& hello) {
  const HostConfig& host = remote.config;
  const ProgramBuild theirs{.text = Quote(hello.build), .sources = hello.sources, .processor = Quote(hello.processor)};
  const std::string why_not =
      WhyNotTogether({.text = BuildText(), .sources = SourcesText(), .processor = ProcessorText()}, theirs);
  if (!why_not.empty()) throw std::runtime_error(fmt::format("host {} {}", host.name, why_not));
  for (const auto& other : remotes_)
    if (other->greeted && other->machine == hello.machine && hello.machine != MachineText())
      throw std::runtime_error(
          fmt::format("hosts {} and {} are one machine: expected each machine once", other->config.name, host.name));
  HostJob job = rules_.job(host, OurAddress(host, hello.seen_from));
  job.own_memory = hello.machine != MachineText();
  for (const HostProcess& process : job.processes)
    remote.logs.emplace(process.name, logs_.Open(process.name, folder_.Log(process.name)));
  HostWords words = WordsOf(job);
  if (host.together) words["node"] = host.name;
  remote.connection.output.Write(CompactJson(words));
  remote.machine = hello.machine;
  remote.greeted = true;
}

/// Throws std::runtime_error if a participant that joined as a process of this host is none that the host has started.
void Launcher::CheckPids(const Remote& remote) const {
  if (remote.pids.empty() || remote.lost || experiment_.network.is_secure()) return;  // certificates say who is who
  for (const auto& [process, key] : peers_.Places()) {
    const auto pid = remote.pids.find(process);
    if (pid != remote.pids.end() && key.IsExact() && !ProcessKey::WithPid(pid->second).Fits(key))
      throw std::runtime_error(
          fmt::format("{} is not the process that host {} has started", process, remote.config.name));
  }
}

void Launcher::TellAll(const HostWords& words) {
  for (const auto& connection : connections_) connection->output.Write(CompactJson(words));
}

void Launcher::Kill() { TellAll({{"kind", "kill"}}); }

bool Launcher::End() {
  ending_ = true;
  TellAll({{"kind", "end"}});
  return std::ranges::any_of(remotes_, [](const auto& remote) { return remote->greeted && !remote->lost; });
}

}  // namespace mascot
