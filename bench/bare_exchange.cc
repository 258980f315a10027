// The bare exchange, a baseline for the DDS engine: the processes and the bus of a run, and samples as large as those
// of network.delivery = "bundled", but no physics, law and recording. The server sends each process the states of its
// agents and of those that they hear. A process that has received them answers with commands. The last one starts the
// next tick.
//   bare_exchange AGENTS ring|complete SECONDS [AGENTS-PER-PROCESS [batch]]   prints one line of JSON: ticks per second
// batch: all processes run with SCHED_BATCH, as in lockstep runs.
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/agent_range.h"
#include "bus/bundle.h"
#include "bus/bus.h"
#include "bus/shared_memory.h"
#include "bus/wire.h"
#include "experiment/graph/graph.h"
#include "orchestrator/engines/dds/machine/domain_lock.h"

extern char** environ;

namespace {

using namespace std::chrono_literals;
using namespace mascot;
using WallClock = std::chrono::steady_clock;

constexpr int kMaxPeers = 20;  // as in orchestrator/engines/dds/engine.cc
constexpr std::int64_t kWarmUpTicks = 50;

struct Setting {
  int agents = 0;
  std::string graph = {};
  int domain = 0;
  std::string discovery = {};  // "": none
  std::vector<AgentRange> processes = {};
};

DomainOptions Options(const Setting& setting, const std::string& name, int participants) {
  DomainOptions options;
  options.domain = setting.domain;
  options.name = name;
  options.server = setting.discovery;
  options.role = setting.discovery.empty() ? DiscoveryRole::kPeer : DiscoveryRole::kClient;
  options.loopback = true;
  options.participants = participants;
  return options;
}

/// Waits until other threads have made the condition true.
template <class Condition>
void Await(const Condition& condition) {
  while (!condition()) std::this_thread::sleep_for(2ms);
}

// --- agents -----------------------------------------------------------------------------------------

[[noreturn]] void RunAgents(const Setting& setting, AgentRange agents) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  Domain domain(Options(setting, ProcessName(agents), 2), [] {});
  RawWriter answers(domain, Topic::Answers(agents));
  BundleWriter answer;
  const RawReader bundles(domain, Topic::Bundle(agents), [&](const RawReader::Bytes& bytes, const Sender& /*sender*/) {
    answer.Begin(static_cast<std::int64_t>(BundleReader(bytes).tick()));
    answer.BeginSection();
    for (int id = agents.first; id <= agents.last; ++id) answer.Add(kCommandBody);
    answers.Write(answer.bytes());
  });
  for (;;) pause();
}

// --- server -----------------------------------------------------------------------------------------

/// A process of agents, as the server sees it.
struct Process {
  AgentRange agents;
  std::size_t states = 0;  // that it gets at each tick
  std::unique_ptr<RawWriter> bundles;
  std::unique_ptr<RawReader> answers;
  std::int64_t answered = 0;
};

/// How many states a process gets: those of its agents, and of those that they hear.
std::size_t StatesOf(const Graph& graph, AgentRange agents) {
  std::set<int> sources;
  for (int id = agents.first; id <= agents.last; ++id) {
    sources.insert(id);
    for (const Graph::Neighbour& heard : graph.HeardBy(id)) sources.insert(heard.id);
  }
  return sources.size();
}

class Server {
 public:
  explicit Server(const Setting& setting)
      : domain_(Options(setting, "server", static_cast<int>(setting.processes.size()) + 2), [] {}) {
    const Graph graph = MakeTopology(setting.graph, setting.agents);
    for (const AgentRange& agents : setting.processes) {
      Process& process = *processes_.emplace_back(std::make_unique<Process>());
      process.states = StatesOf(graph, agents);
      process.bundles = std::make_unique<RawWriter>(domain_, Topic::Bundle(agents));
    }
    for (std::size_t k = 0; k < processes_.size(); ++k)
      processes_[k]->answers = std::make_unique<RawReader>(
          domain_, Topic::Answers(setting.processes[k]),
          [this, &process = *processes_[k]](const RawReader::Bytes& bytes, const Sender& /*sender*/) {
            OnAnswers(process, static_cast<std::int64_t>(BundleReader(bytes).tick()));
          });
  }

  ~Server() {
    for (const auto& process : processes_) process->answers.reset();  // their callbacks write to all processes
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  bool Matched() const {
    return std::ranges::all_of(processes_, [](const auto& process) {
      return process->bundles->matched() >= 1 && process->answers->matched() >= 1;
    });
  }

  /// Measures ticks per second over `seconds`.
  double Measure(double seconds) {
    {
      const std::lock_guard lock(mutex_);
      Publish();
    }
    Await([&] { return tick_ > kWarmUpTicks; });
    const auto start = WallClock::now();
    const std::int64_t first = tick_;
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    const std::int64_t last = tick_;
    return static_cast<double>(last - first) / std::chrono::duration<double>(WallClock::now() - start).count();
  }

 private:
  void Publish() {
    ++tick_;
    missing_ = processes_.size();
    for (const auto& process : processes_) {
      sample_.Begin(tick_);
      sample_.BeginSection(static_cast<std::uint32_t>(process->agents.size()));
      for (std::size_t k = 0; k < process->states; ++k) sample_.Add(kStateBody);
      process->bundles->Write(sample_.bytes());
    }
  }
  void OnAnswers(Process& process, std::int64_t tick) {
    const std::lock_guard lock(mutex_);
    if (tick != tick_ || process.answered == tick) return;
    process.answered = tick;
    if (--missing_ == 0) Publish();
  }

  Domain domain_;
  std::mutex mutex_;
  std::atomic<std::int64_t> tick_ = 0;
  std::size_t missing_ = 0;
  BundleWriter sample_;
  std::vector<std::unique_ptr<Process>> processes_;
};

pid_t Spawn(const Setting& setting, AgentRange agents) {
  std::vector<std::string> words{"bare_exchange",
                                 "agents",
                                 std::to_string(setting.domain),
                                 setting.discovery,
                                 std::to_string(agents.first),
                                 std::to_string(agents.last)};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  if (posix_spawn(&pid, "/proc/self/exe", nullptr, nullptr, argv.data(), environ) != 0) std::exit(1);
  return pid;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() == 5 && words[0] == "agents")
    RunAgents({.agents = 0, .graph = "", .domain = std::stoi(words[1]), .discovery = words[2]},
              {std::stoi(words[3]), std::stoi(words[4])});
  const int share = words.size() < 4 ? 1 : std::atoi(words[3].c_str());
  const bool batch = words.size() == 5 && words[4] == "batch";
  const bool known =
      words.size() >= 3 && std::atoi(words[0].c_str()) > 0 && (words[1] == "ring" || words[1] == "complete");
  if (!known || share < 1 || (words.size() > 4 && !batch)) {
    std::fprintf(stderr, "usage: bare_exchange AGENTS ring|complete SECONDS [AGENTS-PER-PROCESS [batch]]\n");
    return 2;
  }
  const sched_param no_priority{};
  if (batch && sched_setscheduler(0, SCHED_BATCH, &no_priority) != 0) return 1;
  const DomainLock lock(-1);
  Setting setting{.agents = std::stoi(words[0]), .graph = words[1], .domain = lock.domain()};
  for (int first = 1; first <= setting.agents; first += share)
    setting.processes.push_back({first, std::min(first + share - 1, setting.agents)});
  if (std::ssize(setting.processes) + 2 > kMaxPeers)
    setting.discovery = "127.0.0.1:" + std::to_string(lock.discovery_port());
  std::vector<pid_t> agents;
  for (const AgentRange& process : setting.processes) agents.push_back(Spawn(setting, process));
  {
    std::optional<Domain> discovery;
    if (!setting.discovery.empty()) {
      DomainOptions options = Options(setting, "discovery_server", 2);
      options.role = DiscoveryRole::kServer;
      discovery.emplace(options, [] {});
    }
    Server server(setting);
    Await([&] { return server.Matched(); });
    std::this_thread::sleep_for(300ms);  // until the agents have matched too
    std::printf("{\"ticks_per_s\": %.1f}\n", server.Measure(std::atof(words[2].c_str())));
  }
  for (const pid_t agent : agents) {
    kill(agent, SIGKILL);
    waitpid(agent, nullptr, 0);
  }
  SweepSharedMemory(setting.domain);
  return 0;
}
