#include "orchestrator/engines/dds/engine.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "bus/bus.h"
#include "bus/shared_memory.h"
#include "experiment/processes.h"
#include "orchestrator/engines/dds/domain_lock.h"
#include "orchestrator/engines/dds/hub.h"
#include "orchestrator/engines/dds/recorder.h"
#include "orchestrator/engines/dds/wire_audit.h"
#include "orchestrator/engines/row_feed.h"
#include "orchestrator/processes/children.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

/// Above this everybody finding everybody takes longer than asking a server (50: 5 s against 2 s).
constexpr int kMostPeers = 20;
/// How long an orderly end may take before it is made disorderly.
constexpr auto kGrace = 5s;

/// As `agent --id` takes them.
std::string IdsText(AgentRange agents) {
  return std::to_string(agents.first) + (agents.size() > 1 ? "-" + std::to_string(agents.last) : "");
}

/// From now on this thread, and those that it makes, give way to the processes of the run. The recorder hears
/// everything and may lag behind by its window; waking it must not push a process aside that the next tick waits for.
/// (By much more than this, and it starves until the window is full.)
void StepAside() {
  constexpr int kNice = 5;
  setpriority(PRIO_PROCESS, 0, kNice);
}

/// One run, from the domain's lock to the last process gone.
class DdsRun {
 public:
  DdsRun(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks, Console& console,
         StopSignal& stop);
  EngineResult Run();

 private:
  using Deadline = std::optional<WallClock::time_point>;

  DomainOptions Options(const std::string& name, DiscoveryRole role) const;
  int PeersOf(AgentRange agents) const;
  int BundleRoom() const;
  void Join();
  void Spawn();
  void Loop();
  void HandleSignal(int signal);
  std::vector<Exit> Reap();
  void AwaitSignal();
  void CheckChildren();
  void SayReady();
  void Record();
  void CheckWire();
  void CheckDeadlines();
  void CheckProgress();
  std::optional<Hub::Status> ServerReport() const;
  void AwaitLastWords();
  void DrainAll();
  bool in_order() const;
  void AskToEnd();
  void Collect();
  void End();
  void Fail(const std::string& why);

  const Experiment& experiment_;
  Console& console_;
  StopSignal& stop_;
  const WallClock::time_point launched_ = WallClock::now();
  const bool external_;
  EngineResult result_;
  bool finished_ = false;
  bool server_ended_ = false;  // by itself
  bool server_mute_ = false;   // it was killed, or hangs: it will not say anything more
  bool wire_was_complete_ = false;
  Deadline stop_deadline_, drain_deadline_;
  std::int64_t confirmed_ = 0;
  std::int64_t progress_seen_ = -1;
  WallClock::time_point progress_at_;

  const std::vector<AgentRange> processes_;
  const bool with_server_;
  const RunFolder& folder_;
  std::optional<DomainLock> lock_;
  ChildLogs logs_;
  Children children_;
  WireAudit audit_;
  std::optional<Domain> discovery_server_;
  std::optional<Domain> domain_;
  std::optional<Hub> hub_;
  RowFeed feed_;
  std::optional<Recorder> recorder_;
};

DdsRun::DdsRun(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
               Console& console, StopSignal& stop)
    : experiment_(experiment),
      console_(console),
      stop_(stop),
      external_(
          std::any_of(experiment.agents.begin(), experiment.agents.end(), [](const auto& a) { return a.external; })),
      processes_(AgentProcesses(experiment)),
      with_server_(std::ssize(processes_) + 2 > kMostPeers),
      folder_(folder),
      logs_([&console](const std::string& process, const std::string& line) { console.ChildLine(process, line); }),
      children_(logs_),
      feed_(experiment, sinks) {}

void DdsRun::Join() {
  lock_.emplace(experiment_.network.domain);
  SweepSharedMemory();  // of runs that were killed
  Spawn();
  StepAside();
  auto wake = [this] { stop_.Wake(); };
  if (with_server_) discovery_server_.emplace(Options("discovery_server", DiscoveryRole::kServer), [] {});
  domain_.emplace(Options("orchestrator", with_server_ ? DiscoveryRole::kObserver : DiscoveryRole::kPeer), wake,
                  &audit_);
  hub_.emplace(*domain_, experiment_, folder_, wake);
  recorder_.emplace(*domain_, experiment_, feed_);
}

DomainOptions DdsRun::Options(const std::string& name, DiscoveryRole role) const {
  DomainOptions options;
  options.domain = lock_->domain();
  options.transport = experiment_.network.transport;
  options.name = name;
  options.role = role;
  options.loopback = !external_;
  options.participants = experiment_.size() + 2 + BundleRoom();
  const std::string host = role == DiscoveryRole::kServer && external_ ? "0.0.0.0" : "127.0.0.1";
  if (with_server_) options.server = host + ":" + std::to_string(lock_->discovery_port());
  return options;
}

void DdsRun::Spawn() {
  const DomainOptions options = Options("", DiscoveryRole::kClient);
  std::vector<std::string> common{"--domain",    std::to_string(options.domain),
                                  "--transport", options.transport,
                                  "--parent",    std::to_string(getpid()),
                                  "--wait-s",    std::to_string(static_cast<int>(experiment_.run.start_timeout_s) + 1)};
  if (options.loopback) common.push_back("--loopback");
  if (with_server_) common.insert(common.end(), {"--discovery", options.server});
  console_.Line("domain " + std::to_string(options.domain) +
                (with_server_ ? ", discovery server " + options.server : ""));

  const auto spawn = [&](const std::string& process, const std::string& program, int peers,
                         const std::vector<std::string>& more) {
    auto arguments = common;
    arguments.insert(arguments.end(), {"--participants", std::to_string(peers)});
    arguments.insert(arguments.end(), more.begin(), more.end());
    children_.Spawn(process, ProgramFolder() / program, arguments, folder_.Log(process));
  };
  spawn("physics_server", "physics_server", options.participants, {});
  for (const AgentRange& agents : processes_) {
    if (!experiment_.agent(agents.first).external)
      spawn(ProcessName(agents), "agent", PeersOf(agents), {"--id", IdsText(agents)});
    else
      console_.Line("waiting for: agent --id " + IdsText(agents) + " --domain " + std::to_string(options.domain) +
                    (with_server_ ? " --discovery THIS-HOST:" + std::to_string(lock_->discovery_port()) : ""));
  }
}

/// How many topics of others the agents' process deals with in a tick, and how many of its own.
int DdsRun::PeersOf(AgentRange agents) const {
  if (agents.size() == 1) return 2;
  std::size_t topics = 2;
  for (int id = agents.first; id <= agents.last; ++id) topics += 2 + experiment_.graph.HeardBy(id).size();
  return static_cast<int>(std::min<std::size_t>(topics, 20000));
}

/// Bundles that are on their way at once need room beyond that of single states.
int DdsRun::BundleRoom() const {
  if (experiment_.network.delivery != Delivery::kBundled) return 0;
  constexpr std::size_t kStatesPerPeer = 32 * 1024 / 176;  // bus/qos.cc reserves 32 KiB for each
  return static_cast<int>(std::min<std::size_t>(experiment_.graph.edges() / kStatesPerPeer, 10000));
}

EngineResult DdsRun::Run() {
  try {
    Join();
    Loop();
  } catch (const std::exception& failure) {
    Fail(failure.what());
  }
  if (recorder_) Collect();
  End();
  return result_;
}

/// What the physics server measured in the run, which it tells when it ends; nothing before.
std::optional<Hub::Status> DdsRun::ServerReport() const {
  auto server = hub_->StatusOf("physics_server");
  if (recorder_->newest_tick() < 0 || !server || !IsLast(static_cast<Life>(server->state()))) return std::nullopt;
  return server;
}

/// Where the run did not end in order, but the server lives: it is told to end, and so to report. Of a server that
/// ended by itself: that it has gone may be known before what it said last.
void DdsRun::AwaitLastWords() {
  if (in_order() || ServerReport() || server_mute_ || recorder_->newest_tick() < 0) return;
  if (!server_ended_) AskToEnd();
  auto deadline = WallClock::now() + 2 * kGrace;  // a killed agent's lock may hold up the server, and then us
  while (!ServerReport() && !server_mute_ && WallClock::now() < deadline) {
    if (server_ended_) deadline = std::min(deadline, WallClock::now() + 1s);
    if (stop_.Within(10ms) != 0) return;
    Reap();  // they have been asked to end
  }
}

/// All rows there are, or those before the next signal: a slow law makes them slow.
void DdsRun::DrainAll() {
  for (std::int64_t rows = -1; rows != confirmed_;) {
    rows = confirmed_;
    confirmed_ = recorder_->Drain(/*give_up=*/true);
    if (const int signal = stop_.Within(0ms); signal != 0) return HandleSignal(signal);
  }
}

void DdsRun::Collect() {
  try {
    DrainAll();
  } catch (const std::exception& failure) {
    Fail(failure.what());
  }
  result_.lost = recorder_->lost();
  const bool violated = !audit_.Violation(experiment_).empty();
  if (violated || wire_was_complete_) result_.wire_matches_graph = !violated;
  if (recorder_->newest_tick() >= 0) {
    result_.wall_s = recorder_->wall_s();
    result_.startup_s = std::chrono::duration<double>(recorder_->started() - launched_).count();
  }
  AwaitLastWords();
  const auto server = ServerReport();
  if (!server) return;
  result_.contacts = {.agents = static_cast<std::int64_t>(server->agent_contacts()),
                      .ground = static_cast<std::int64_t>(server->ground_contacts()),
                      .obstacles = static_cast<std::int64_t>(server->obstacle_contacts())};
  if (experiment_.run.mode == Mode::kRealtime)
    result_.pacing = {.misses = server->misses(),
                      .tick_lateness_s = server->tick_lateness_s(),
                      .command_age_s = server->command_age_s()};
}

void DdsRun::Loop() {
  while (!finished_) {
    HandleSignal(stop_.Within(50ms));
    domain_->RethrowFailure();
    CheckChildren();
    hub_->HandOutExperiment();
    CheckWire();
    SayReady();
    Record();
    CheckDeadlines();
  }
}

void DdsRun::HandleSignal(int signal) {
  if (signal == 0) return;
  if (result_.signal != 0) {  // the second time: at once
    children_.Kill();
    server_mute_ = true;
    finished_ = true;
    return;
  }
  result_.signal = signal;
  console_.Line("stopping (once more to kill)");
  hub_->Ask(Ask::kStop, strsignal(signal));
  stop_deadline_ = WallClock::now() + kGrace;
  if (recorder_->newest_tick() < 0) finished_ = true;  // nothing flies yet
}

/// Children that have ended by themselves.
std::vector<Exit> DdsRun::Reap() {
  std::vector<Exit> exits = children_.Reap();
  for (const Exit& exit : exits)
    if (exit.process == "physics_server") (WIFEXITED(exit.status) ? server_ended_ : server_mute_) = true;
  return exits;
}

/// Who ends a whole job (systemd, a batch system) signals all of its processes, us a little later, maybe.
void DdsRun::AwaitSignal() {
  const auto deadline = WallClock::now() + 100ms;
  while (result_.signal == 0 && WallClock::now() < deadline) HandleSignal(stop_.Within(10ms));
}

void DdsRun::CheckChildren() {
  const std::vector<Exit> exits = Reap();
  if (exits.empty()) return;
  const auto code = [](const Exit& exit) { return WIFEXITED(exit.status) ? WEXITSTATUS(exit.status) : 0; };
  if (std::ranges::any_of(exits, [&](const Exit& exit) { return code(exit) > 128; })) AwaitSignal();
  finished_ = true;
  std::string failure;
  for (const Exit& exit : exits) {
    if (result_.signal != 0 && code(exit) == 128 + result_.signal) continue;
    failure += (failure.empty() ? "" : "\n") + exit.process + " " + exit.Text();
    for (const std::string& line : logs_.LastLines(exit.process)) failure += "\n  " + exit.process + " | " + line;
  }
  if (!failure.empty()) Fail(failure);
}

/// Where somebody is on the wire who should not be, that is why, whoever stumbles over it first.
void DdsRun::Fail(const std::string& why) {
  finished_ = true;
  if (!result_.failure.empty()) return;
  const std::string violation = audit_.Violation(experiment_);
  result_.failure = violation.empty() ? why : "the wire differs from the graph: " + violation;
}

void DdsRun::CheckWire() {
  if (audit_.HasNews() && !audit_.Violation(experiment_).empty()) Fail("");
}

void DdsRun::SayReady() {
  if (recorder_->newest_tick() >= 0 || !recorder_->Matched() || !audit_.IsComplete(experiment_)) return;
  wire_was_complete_ = true;
  hub_->SayReady();
}

void DdsRun::Record() {
  const auto server = hub_->StatusOf("physics_server");
  const bool done = server && static_cast<Life>(server->state()) == Life::kDone;
  const bool give_up = drain_deadline_ && WallClock::now() > *drain_deadline_;
  const std::int64_t rows = recorder_->Drain(give_up);
  const bool more = rows > confirmed_;
  if (more) hub_->Confirm(rows);
  confirmed_ = rows;
  if (!done) return;
  if (rows == static_cast<std::int64_t>(server->tick()) + 1)
    finished_ = true;
  else if (give_up && !more)
    Fail("the recording is not complete: " + std::to_string(rows) + " of " + std::to_string(server->tick() + 1) +
         " ticks");
  else if (!drain_deadline_)
    drain_deadline_ = WallClock::now() + (experiment_.run.mode == Mode::kRealtime ? 1s : kGrace);
}

void DdsRun::CheckDeadlines() {
  if (stop_deadline_ && WallClock::now() > *stop_deadline_) finished_ = true;  // what there is is recorded
  const auto start_limit = std::chrono::duration<double>(experiment_.run.start_timeout_s) + kGrace;
  if (recorder_->newest_tick() < 0 && WallClock::now() - launched_ > start_limit)
    Fail("not started within run.start_timeout_s = " + ShortestFloat(experiment_.run.start_timeout_s) +
         " s: " + hub_->Unheard());
  CheckProgress();
}

/// The server tells of agents that fall silent; of a silent server, we must.
void DdsRun::CheckProgress() {
  const auto now = WallClock::now();
  const std::int64_t newest = recorder_->newest_tick();
  if (newest < 0 || newest + confirmed_ != progress_seen_ || drain_deadline_) {
    progress_seen_ = newest + confirmed_;
    progress_at_ = now;
    return;
  }
  const double period_s = experiment_.run.mode == Mode::kRealtime ? experiment_.period_s() / experiment_.run.speed : 0;
  const double limit_s = experiment_.run.agent_timeout_s + period_s;
  if (now - progress_at_ < std::chrono::duration<double>(limit_s) + kGrace) return;
  server_mute_ = true;
  Fail("nothing came from physics_server for " +
       ShortestFloat(limit_s + std::chrono::duration<double>(kGrace).count()) + " s");
}

bool DdsRun::in_order() const { return result_.failure.empty() && result_.signal == 0; }

void DdsRun::AskToEnd() try {
  hub_->Ask(Ask::kEnd, in_order() ? "done" : result_.failure.substr(0, 1000));
} catch (const BusError& error) {  // then signals must do
  console_.Line(error.what());
}

void DdsRun::End() {
  if (hub_) AskToEnd();
  if (in_order()) children_.WaitAll(kGrace);
  children_.Stop(2s);
  // Those started by hand are not ours to reap, only to be told.
  const auto deadline = WallClock::now() + 2s;
  while (external_ && hub_ && hub_->listeners() > 0 && WallClock::now() < deadline) stop_.Within(20ms);
  recorder_.reset();
  hub_.reset();
  domain_.reset();
  discovery_server_.reset();
  SweepSharedMemory();
}

}  // namespace

EngineResult RunOverDds(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
                        Console& console, StopSignal& stop) {
  return DdsRun(experiment, folder, sinks, console, stop).Run();
}

}  // namespace mascot
