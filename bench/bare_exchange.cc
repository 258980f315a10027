// The bare exchange, a baseline for the DDS engine: the processes, topics, readers, messages and bus of a run, but no
// physics, law and recording. The server publishes the states of all agents. An agent that has received its own state
// and its neighbours' states of a tick answers with a command. The last command starts the next tick.
//   bare_exchange AGENTS ring|complete SECONDS [batch]     prints one line of JSON: ticks per second
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
#include <string>
#include <thread>
#include <vector>

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
constexpr std::uint64_t kWarmUpTicks = 50;

struct Setting {
  int agents = 0;
  std::string graph;
  int domain = 0;
  std::string discovery;  // "": none
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

[[noreturn]] void RunAgent(const Setting& setting, int id) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const Graph graph = MakeTopology(setting.graph, setting.agents);
  Domain domain(Options(setting, AgentName(id), 2), [] {});
  Writer<CommandType> commands(domain, Topic::Command(id));
  mascot_msgs::msg::AgentCommand command;
  std::mutex mutex;
  std::vector<std::uint64_t> ticks(graph.HeardBy(id).size() + 1, 0);  // newest tick by source; ticks start at 1
  std::vector<std::unique_ptr<Reader<StateType>>> readers;
  const auto listen = [&](std::size_t source, int from) {
    readers.push_back(std::make_unique<Reader<StateType>>(
        domain, Topic::State(from), [&, source](const mascot_msgs::msg::AgentState& state) {
          const std::lock_guard lock(mutex);
          ticks[source] = state.tick();
          if (std::ranges::any_of(ticks, [&](std::uint64_t tick) { return tick != ticks[0]; })) return;
          command.tick(ticks[0]);
          commands.Write(command);
        }));
  };
  listen(0, id);
  for (std::size_t k = 0; k < graph.HeardBy(id).size(); ++k) listen(k + 1, graph.HeardBy(id)[k].id);
  for (;;) pause();
}

// --- server -----------------------------------------------------------------------------------------

class Server {
 public:
  explicit Server(const Setting& setting)
      : domain_(Options(setting, "server", setting.agents + 2), [] {}),
        answered_(static_cast<std::size_t>(setting.agents), 0),
        hearers_(static_cast<std::size_t>(setting.agents), 1) {
    const Graph graph = MakeTopology(setting.graph, setting.agents);
    for (int id = 1; id <= setting.agents; ++id) {
      for (const Graph::Neighbour& heard : graph.HeardBy(id)) ++hearers_[static_cast<std::size_t>(heard.id - 1)];
      states_.push_back(std::make_unique<Writer<StateType>>(domain_, Topic::State(id)));
      commands_.push_back(std::make_unique<Reader<CommandType>>(
          domain_, Topic::Command(id),
          [this, id](const mascot_msgs::msg::AgentCommand& command) { OnCommand(id, command.tick()); }));
    }
  }

  bool Matched() const {
    for (std::size_t i = 0; i < states_.size(); ++i)
      if (states_[i]->matched() < hearers_[i] || commands_[i]->matched() < 1) return false;
    return true;
  }

  /// Measures ticks per second over `seconds`.
  double Measure(double seconds) {
    {
      const std::lock_guard lock(mutex_);
      Publish();
    }
    Await([&] { return tick_ > kWarmUpTicks; });
    const auto start = WallClock::now();
    const std::uint64_t first = tick_;
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    const std::uint64_t last = tick_;
    return static_cast<double>(last - first) / std::chrono::duration<double>(WallClock::now() - start).count();
  }

 private:
  void Publish() {
    ++tick_;
    missing_ = static_cast<int>(states_.size());
    sample_.tick(tick_);
    for (const auto& state : states_) state->Write(sample_);
  }
  void OnCommand(int id, std::uint64_t tick) {
    const std::lock_guard lock(mutex_);
    std::uint64_t& last = answered_[static_cast<std::size_t>(id - 1)];
    if (tick != tick_ || last == tick) return;
    last = tick;
    if (--missing_ == 0) Publish();
  }

  Domain domain_;
  std::mutex mutex_;
  std::atomic<std::uint64_t> tick_ = 0;
  int missing_ = 0;
  std::vector<std::uint64_t> answered_;
  std::vector<int> hearers_;
  mascot_msgs::msg::AgentState sample_;
  std::vector<std::unique_ptr<Writer<StateType>>> states_;
  std::vector<std::unique_ptr<Reader<CommandType>>> commands_;
};

pid_t Spawn(const Setting& setting, int id) {
  std::vector<std::string> words{"bare_exchange",
                                 "agent",
                                 std::to_string(setting.agents),
                                 setting.graph,
                                 std::to_string(setting.domain),
                                 setting.discovery,
                                 std::to_string(id)};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  if (posix_spawn(&pid, "/proc/self/exe", nullptr, nullptr, argv.data(), environ) != 0) std::exit(1);
  return pid;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 7 && std::string(argv[1]) == "agent")
    RunAgent({std::atoi(argv[2]), argv[3], std::atoi(argv[4]), argv[5]}, std::atoi(argv[6]));
  const bool batch = argc == 5 && std::string(argv[4]) == "batch";
  const bool known =
      argc >= 4 && std::atoi(argv[1]) > 0 && (std::string(argv[2]) == "ring" || std::string(argv[2]) == "complete");
  if (!known || (argc != 4 && !batch)) {
    std::fprintf(stderr, "usage: bare_exchange AGENTS ring|complete SECONDS [batch]\n");
    return 2;
  }
  const sched_param no_priority{};
  if (batch && sched_setscheduler(0, SCHED_BATCH, &no_priority) != 0) return 1;
  const DomainLock lock(-1);
  Setting setting{std::atoi(argv[1]), argv[2], lock.domain(), ""};
  if (setting.agents + 2 > kMaxPeers) setting.discovery = "127.0.0.1:" + std::to_string(lock.discovery_port());
  std::vector<pid_t> agents;
  for (int id = 1; id <= setting.agents; ++id) agents.push_back(Spawn(setting, id));
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
    std::printf("{\"ticks_per_s\": %.1f}\n", server.Measure(std::atof(argv[3])));
  }
  for (const pid_t agent : agents) {
    kill(agent, SIGKILL);
    waitpid(agent, nullptr, 0);
  }
  SweepSharedMemory(setting.domain);
  return 0;
}
