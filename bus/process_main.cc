#include "bus/process_main.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/addresses.h"
#include "bus/leave.h"
#include "bus/ports.h"
#include "bus/resources.h"
#include "bus/shared_memory.h"
#include "experiment/experiment.h"
#include "experiment/processes.h"
#include "system/descendants.h"
#include "system/failure.h"
#include "system/left_file.h"
#include "system/private_folder.h"
#include "system/spawn.h"
#include "system/turn.h"
#include "system/usage.h"

namespace mascot {
namespace {

constexpr auto kTimeToLeave = std::chrono::seconds(5);
constexpr auto kTimeToReport = std::chrono::seconds(3);  // see Lifecycle::SetFinal()
/// For what an agent has written before it is lost. A neighbour that hangs takes nothing.
constexpr auto kTimeToDeliver = std::chrono::seconds(2);
constexpr int kTimeToBeRead_ms = 300;   // in which others read what PlacesOfTheRun has sent them
constexpr int kHeads = 2;               // the orchestrator and the physics server
constexpr int kTurns = 4;               // see JoinDomain()
constexpr int kKilled = 128 + SIGKILL;  // exit code after KilledByEvent, if this process does not end by itself

/// "3" or "1-50".
AgentRange ParseIds(const std::string& text) {
  const auto dash = text.find('-');
  const std::string name = (dash == text.npos ? "agent_" : "agents_") + text;
  const auto agents = AgentsOf(name);
  if (!agents || agents->first < 1 || agents->last > kMaxAgents)
    throw CLI::ValidationError("--id", "expected a number, or two such as 1-50, in 1 to " + std::to_string(kMaxAgents) +
                                           ", got '" + text + "'");
  return *agents;
}

/// See kSweepAfterRun. What laws have started has outlived the run if its orchestrator was killed. Files of a process
/// that is just ending are in use for another moment: sweeps until that is over.
int SweepAfterRun(int domain) {
  constexpr int kSweeps = 4;
  constexpr int kMoment_ms = 50;
  std::string words;
  std::array<char, 4096> bytes{};
  ssize_t got = 0;
  do {
    got = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got > 0) words.append(bytes.data(), static_cast<std::size_t>(got));
  } while (got > 0 || (got < 0 && errno == EINTR));
  KillMarked();
  if (const auto end = words.find('\0'); end != words.npos) LeftFile(words.c_str()).Write(words.substr(end + 1));
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    SweepSharedMemory(domain);
    SweepPrivateFolders();
    poll(nullptr, 0, kMoment_ms);
  }
  return 0;
}

int SweepSegments(int code) {
  SweepSharedMemory(kNoDomain);
  SweepPrivateFolders();
  return code;
}

/// Prepares to leave the domain: from now on the process ends within `limit`.
void Leave(const ProcessArgs& args, std::chrono::seconds limit, int code) {
  const bool by_hand = args.parent == 0;  // else the orchestrator kills and sweeps, or its Janitor
  LeaveWithin(limit, {.code = code, .process = args.options.name, .on_signals = by_hand, .sweeps = by_hand});
}

/// At its end, prints how many samples were not taken, and of which participants.
class Refusals {
 public:
  explicit Refusals(const Peers& peers) : peers_(peers) {}
  ~Refusals() {
    for (const std::string& line : peers_.Refusals()) std::cerr << line << std::endl;
  }
  Refusals(const Refusals&) = delete;
  Refusals& operator=(const Refusals&) = delete;

 private:
  const Peers& peers_;
};

/// Domain::AwaitOthers(); the physics server is looked for. Returns a signal that came, or 0.
int AwaitOthers(Domain& domain, int others, const ProcessArgs& args, StopSignal& stop) {
  int signal = 0;
  domain.AwaitOthers(others, /*announces=*/!args.is_agent(),
                     [&](std::chrono::nanoseconds time) { return (signal = stop.Within(time)) == 0; });
  return signal;
}

/// The processes of the run that an experiment names.
std::vector<Peers::Place> PlacesOf(const mascot_msgs::msg::Experiment& experiment) {
  std::vector<Peers::Place> places;
  for (const auto& process : experiment.processes())
    places.emplace_back(process.name().to_string(), ProcessKey(process.bits(), process.mask()));
  return places;
}

/// Listens to the experiment of a domain under a name that no process of a run has, which disturbs nobody. It stays in
/// the domain as long as its process: if it left before others had read what it sent, they might become deaf
/// (ReceiveDiscoveryByUdp in bus/qos.cc).
class PlacesOfTheRun {
 public:
  PlacesOfTheRun(DomainOptions options, StopSignal& stop)
      : stop_(stop),
        domain_(WithName(std::move(options)), [this] { stop_.Wake(); }),
        reader_(domain_, Topic::Experiment(),
                [this](const mascot_msgs::msg::Experiment& experiment) { Take(experiment); }) {}

  /// The processes of the run. Throws Ended after a signal, std::runtime_error if no experiment comes.
  std::vector<Peers::Place> Await(std::chrono::seconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    for (;;) {
      {
        const std::lock_guard lock(mutex_);
        if (places_) return *places_;
      }
      const auto left = deadline - std::chrono::steady_clock::now();
      if (left <= left.zero()) throw std::runtime_error(NoExperiment(timeout));
      if (const int signal = stop_.Within(left); signal != 0) throw Ended(signal);
    }
  }

 private:
  static DomainOptions WithName(DomainOptions options) {
    options.name = "listener";
    options.number = -1;  // the agent's participant has that of --participant
    return options;
  }
  void Take(const mascot_msgs::msg::Experiment& experiment) {
    const std::lock_guard lock(mutex_);
    places_ = PlacesOf(experiment);
    stop_.Wake();
  }

  StopSignal& stop_;
  std::mutex mutex_;
  std::optional<std::vector<Peers::Place>> places_;  // guarded by mutex_
  Domain domain_;
  Reader<ExperimentType> reader_;
};

/// Why a run with these processes does not wait for this agent, which was started by hand; empty: it does. `is_free`
/// says whether the key of a place leaves it to this process.
template <class IsFree>
std::string WhyNotAwaited(const ProcessArgs& args, const std::vector<Peers::Place>& places, const IsFree& is_free) {
  std::string awaited;
  bool is_there = false;
  for (const auto& [process, key] : places) {
    is_there = is_there || process == args.options.name;
    const auto agents = AgentsOf(process);
    if (!agents || !is_free(key)) continue;
    if (process == args.options.name) return "";
    awaited += (awaited.empty() ? "" : ", ") + IdsText(*agents);
  }
  return "--id " + IdsText(args.agents) + ": expected " +
         (awaited.empty() ? "no agent, because the run waits for none"
                          : "an agent for which the run waits (" + awaited + ")") +
         ", got one that " + (is_there ? "is there already" : "the run does not have");
}

/// An agent that was started by hand looks first whether the run waits for it: as one that is not awaited, it would end
/// the run of all others. Returns the exit code with which it ends; nothing: it goes on.
std::optional<int> RefuseIfNotAwaited(const ProcessArgs& args, PlacesOfTheRun& run) {
  int code = 1;
  std::string error;
  try {
    error = WhyNotAwaited(args, run.Await(std::chrono::seconds(args.wait_s)), std::mem_fn(&ProcessKey::IsNobody));
    if (error.empty()) return std::nullopt;
    code = 2;
  } catch (const Ended& ended) {
    code = 128 + ended.signal();
  } catch (const std::exception& failure) {
    error = InWords(failure);
  }
  if (!error.empty()) std::cerr << "error: " << error << std::endl;
  poll(nullptr, 0, kTimeToBeRead_ms);
  Leave(args, kTimeToLeave, code);
  return code;
}

std::string NameOf(const ProcessArgs& args) {
  switch (args.kind) {
    case ProcessArgs::Kind::kServer:
      return kPhysicsServer;
    case ProcessArgs::Kind::kAgents:
      return ProcessName(args.agents);
    case ProcessArgs::Kind::kVehicle:
      return VehicleName(args.agents.first);
  }
  throw std::logic_error("a process of no kind");
}

/// The run does not wait for an agent that was started by hand.
class NotAwaited : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws NotAwaited if the run does not wait for this agent: its credentials serve one process at a time. Nobody takes
/// for the agent's what a second one says.
void RequirePlace(const ProcessArgs& args, const Domain& domain, const mascot_msgs::msg::Experiment& experiment) {
  const std::string why = WhyNotAwaited(args, PlacesOf(experiment), [&](const ProcessKey& key) {
    return !key.IsExact() || key.Fits(domain.guid_prefix());
  });
  if (!why.empty()) throw NotAwaited(why);
}

/// What is known of the orchestrator before it has said anything.
ProcessKey KeyOfOrchestrator(const ProcessArgs& args) {
  if (args.options.credentials != nullptr) return args.options.credentials->orchestrator;
  const int orchestrator = args.orchestrator != 0 ? args.orchestrator : args.parent;
  return orchestrator != 0 ? ProcessKey::WithPid(orchestrator) : ProcessKey::Anybody();
}

/// Throws std::invalid_argument if there are none that this process may use.
std::shared_ptr<const Credentials> CredentialsIn(const std::string& file) try {
  return std::make_shared<const Credentials>(ReadCredentials(file));
} catch (const std::runtime_error& wrong) {
  throw std::invalid_argument(std::string("--credentials: ") + wrong.what());
}

/// Reads the credentials. Whoever has started this process for a run has made the file for it alone: it goes.
void TakeCredentials(ProcessArgs& args) {
  if (args.credentials_file.empty()) return;
  auto credentials = CredentialsIn(args.credentials_file);
  if (args.parent != 0) {
    std::filesystem::remove(args.credentials_file);
    if (args.is_agent()) args.turns = std::filesystem::path(args.credentials_file).parent_path();
  }
  if (credentials->process != args.options.name)
    throw std::invalid_argument("--credentials: expected those of " + args.options.name + ", got those of " +
                                credentials->process);
  args.options.credentials = std::move(credentials);
  if (!args.options.peers.empty()) return;
  // Fast DDS may forget a handshake with a participant of which it hears by two ways at once, as by multicast.
  args.options.peers = {kNumberOfOrchestrator, kNumberOfServer};
  args.awaited = kHeads;
}

/// Joins the domain, and waits for those that this process needs (ProcessArgs::awaited). With credentials, only kTurns
/// processes of a host authenticate themselves at a time. Fast DDS 2.9 sends each word of a handshake to all, and says
/// it again if no answer comes within a second: while it does, it may drop or free another word, in an unguarded moment
/// (WriterHistory::remove_change_and_reuse). Returns the signal that came first; 0: none.
int JoinDomain(const ProcessArgs& args, StopSignal& stop, Peers& peers, std::optional<Domain>& domain) {
  std::optional<Turn> turn;
  if (!args.turns.empty()) turn.emplace(args.turns / fmt::format("turn_{}", getpid() % kTurns));
  if (const int signal = stop.Within({}); signal != 0) return signal;
  domain.emplace(
      args.options, [&stop] { stop.Wake(); }, &peers);
  if (turn)  // others of its host, with which it exchanges messages, may wait for a turn
    if (const int signal = AwaitOthers(*domain, std::min(args.awaited, kHeads), args, stop); signal != 0) return signal;
  turn.reset();
  return AwaitOthers(*domain, args.awaited, args, stop);
}

/// Joins the domain and runs its role. Publishes a failure before it leaves. Returns the exit code.
int Join(const ProcessArgs& args, StopSignal& stop, const RoleFactory& make_role) {
  Peers peers;
  peers.Know(kOrchestrator, KeyOfOrchestrator(args));
  std::optional<Domain> joined;
  if (const int signal = JoinDomain(args, stop, peers, joined); signal != 0) return 128 + signal;
  Domain& domain = *joined;
  const Refusals refusals(peers);
  Lifecycle lifecycle(domain, peers, stop, args.options.name, args.agents.size() == 1 ? args.agents.first : 0);
  std::unique_ptr<Role> role;  // destroyed after the exit code is known: that may hang
  std::optional<mascot_msgs::msg::Experiment> experiment;
  int code = 1;
  try {
    experiment = lifecycle.AwaitExperiment(std::chrono::seconds(args.wait_s), args.from_tick);
    if (args.IsByHand() && args.options.credentials != nullptr) RequirePlace(args, domain, *experiment);
    role = make_role(domain, lifecycle, *experiment);
    role->Run();
  } catch (const Ended& ended) {
    code = ended.signal() == 0 ? 0 : 128 + ended.signal();
    if (args.IsByHand() && code != 0) {  // the others go on, and must have read what it sent, as with PlacesOfTheRun
      Leave(args, kTimeToDeliver + kTimeToLeave, code);
      domain.AwaitReaders(kTimeToDeliver);
    }
  } catch (const KilledByEvent&) {
    Leave(args, kTimeToDeliver + kTimeToLeave, kKilled);
    domain.AwaitReaders(kTimeToDeliver);
    code = kKilled;
  } catch (const NotAwaited& refusal) {
    std::cerr << "error: " << refusal.what() << std::endl;
    code = 2;
  } catch (const std::exception& failure) {
    Leave(args, kTimeToDeliver + kTimeToReport + kTimeToLeave, code);
    std::cerr << "error: " << InWords(failure) << std::endl;
    if (args.is_agent()) domain.AwaitReaders(kTimeToDeliver);
    lifecycle.SetFinal(Life::kFailed, InWords(failure));
  }
  if (experiment) KillDescendants();  // of laws: without an experiment none has run
  Leave(args, kTimeToLeave, code);
  return code;
}

}  // namespace

void ProcessArgs::AddTo(CLI::App& app) {
  if (kind != Kind::kServer)
    app.add_option_function<std::string>(
           "--id", [this](const std::string& text) { agents = ParseIds(text); },
           "This agent's number, 1..N, or those of all agents that share this process: 1-50")
        ->required();
  if (is_agent())
    app.add_flag("--no-code", no_code,
                 "Refuse laws of users: fly no code that comes with the experiment, or that it names");
  app.add_option("--domain", options.domain, "DDS domain of the run; `orchestrator up` prints it")
      ->required()
      ->check(CLI::Range(0, 232));
  app.add_option("--discovery", options.server, "IP-ADDRESS:PORT of the run's discovery server, if it has one");
  app.add_option("--transport", options.transport, "auto (shared memory on one host, UDP between hosts), udp or shm");
  app.add_option("--wait-s", wait_s, "How long to wait for an orchestrator")->check(CLI::Range(1, 86400));
  app.add_flag("--loopback", options.loopback, "Use only 127.0.0.1: everything runs on this host");
  app.add_option("--participants", options.participants, "How many processes this one talks to, about; sizes buffers")
      ->check(CLI::Range(1, 20000));
  app.add_option("--participant", options.number, "Number of this process among those of its host: its ports")
      ->check(CLI::Range(0, kParticipantsPerDomain - 1));
  app.add_option("--peers", options.peers,
                 "Numbers of the processes to announce this one to (default: by multicast, to all)")
      ->delimiter(',')
      ->check(CLI::Range(0, kParticipantsPerDomain - 1));
  app.add_option("--peers-at", options.peers_at, "IPv4 address of the host of --peers (default: 127.0.0.1)");
  app.add_option("--awaits", awaited, "How many participants this one waits for before it makes readers and writers")
      ->check(CLI::Range(0, 20000));
  app.add_flag("--patient", options.patient,
               "Others wait for this process without a limit, and do not take it for gone: it runs in a debugger");
  app.add_option("--from-tick", from_tick, "The first tick that this process answers, after a restart")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000'000}));
  app.add_option("--parent", parent, "Process id of the program that spawned this process: end when it dies");
  app.add_option("--orchestrator", orchestrator, "Process id of the orchestrator, if it is on another host");
  app.add_option(
      "--credentials", credentials_file,
      "The credentials of this process, in a run with network.security; `orchestrator up` prints where they are");
  app.add_option("--address", options.address, "IPv4 address of the interface to use (default: all)");
}

int ProcessMain(CLI::App& app, int argc, char** argv, ProcessArgs& args, StopSignal& stop,
                const RoleFactory& make_role) {
  SayWhatIsUncaught();
  if (argc == 3 && std::string_view(argv[1]) == kSweep) return SweepSegments(std::atoi(argv[2]));
  if (argc == 3 && std::string_view(argv[1]) == kSweepAfterRun) return SweepAfterRun(std::atoi(argv[2]));
  args.AddTo(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    std::cerr << "error: " << UsageText(app, error) << std::endl;
    return 2;
  }
  AdoptDescendants();
  std::signal(SIGPIPE, SIG_IGN);  // clean up even if stderr is the pipe of a dead orchestrator
  close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);  // what a law starts is no process of the run (Janitor)
  // This process may be stopped, or hang in a law or in Fast DDS, when the orchestrator dies; the Janitor sweeps.
  if (args.parent != 0 && !DieWith(args.parent)) return 1;
  args.options.name = NameOf(args);
  if (!args.options.server.empty()) args.options.role = DiscoveryRole::kClient;
  try {
    TakeCredentials(args);
    RequireAddresses(args.options);
    const bool looks_first = args.IsByHand() && args.options.credentials == nullptr;
    const std::uint64_t participants = looks_first ? 2 : 1;
    if (args.parent == 0)  // else the orchestrator has asked
      RequireResources({.shared_memory = participants * SharedMemoryNeeded(args.options)});
    std::optional<PlacesOfTheRun> run;
    if (looks_first)
      if (const auto code = RefuseIfNotAwaited(args, run.emplace(args.options, stop))) return *code;
    const int code = Join(args, stop, make_role);
    if (code == kKilled) raise(SIGKILL);
    return code;
  } catch (const std::invalid_argument& usage) {
    std::cerr << "error: " << usage.what() << std::endl;
    return 2;
  } catch (const std::exception& failure) {
    std::cerr << "error: " << InWords(failure) << std::endl;
    if (args.parent != 0) return 1;  // the orchestrator sweeps
    LeaveNow({.code = 1, .process = args.options.name, .says_so = false, .sweeps = true});
  }
}

}  // namespace mascot
