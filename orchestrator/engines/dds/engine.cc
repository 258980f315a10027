#include "orchestrator/engines/dds/engine.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <optional>
#include <thread>
#include <utility>

#include "base/utf8.h"
#include "bus/addresses.h"
#include "bus/bus.h"
#include "bus/leave.h"
#include "bus/obituary.h"
#include "bus/resources.h"
#include "bus/shared_memory.h"
#include "experiment/processes.h"
#include "orchestrator/engines/dds/action_sender.h"
#include "orchestrator/engines/dds/bounded_call.h"
#include "orchestrator/engines/dds/credentials.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/dds/fleet_links.h"
#include "orchestrator/engines/dds/hosts/launcher.h"
#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "orchestrator/engines/dds/machine/janitor.h"
#include "orchestrator/engines/dds/recorder.h"
#include "orchestrator/engines/dds/ros_publisher.h"
#include "orchestrator/engines/dds/run_layout.h"
#include "orchestrator/engines/dds/run_links.h"
#include "orchestrator/engines/dds/run_phases.h"
#include "orchestrator/engines/dds/wire_audit.h"
#include "orchestrator/engines/row_feed.h"
#include "system/children.h"
#include "system/descendants.h"
#include "system/failure.h"
#include "system/private_folder.h"

namespace mascot {
namespace {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

/// How long children may take to exit by themselves at the end; longer as long as other hosts tell what theirs printed.
constexpr auto kExitGrace = 5s, kLastWords = 60s;
/// File descriptors of the orchestrator: with viewers; and for each process of the run (2 were counted).
constexpr int kOwnDescriptors = 120, kDescriptorsPerProcess = 3;
/// How long the DDS library may take for a call at the end of a run.
constexpr auto kLibraryGrace = 5s;
/// How long after a process was killed Fast DDS may still replace the queue in shared memory of which that had the
/// lock.
constexpr auto kQueueHeals = 3s;
/// How often a process is started afresh at one tick before the run fails.
constexpr int kMaxStarts = 10;
/// A host is lost before its agents are: within this part of run.agent_timeout_s. A host is more patient with us.
constexpr double kShareOfTimeout = 0.6, kMinSilence_s = 2, kHostPatience_s = 10;

/// Lowers the priority of this thread, and of those that it starts, below that of the other processes of the run. The
/// recorder receives every sample and may lag behind by its window; it must not take the processor from a process that
/// the next tick waits for. (With a much larger nice value it starves until the window is full.)
void LowerPriority() {
  constexpr int kNice = 5;
  setpriority(PRIO_PROCESS, 0, kNice);
}

}  // namespace

/// One run, from locking the domain until the last process has ended. RunPhases makes the decisions; DdsRun carries
/// them out.
class DdsRun {
 public:
  DdsRun(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
         RunRequests* requests, Console& console, StopSignal& stop, RosSource* ros, ActionSource* actions,
         Stepper* stepper);
  void LeaveIfKilled(const std::string& path, const std::string& text) { last_words_ = {path, text}; }
  EngineResult Fly();
  bool End(bool process_goes_on);

 private:
  DomainOptions Options(const std::string& name, DiscoveryRole role) const;
  DomainOptions OwnOptions() const;
  std::vector<std::string> CredentialsFor(const std::string& process);
  ProcessKey KeyOf(const std::string& process, pid_t pid) const;
  std::vector<std::string> ArgumentsOfVehicle(int vehicle) const;
  HostJob JobOf(const HostConfig& host, const std::string& our_address);
  RunPhases::Rules Rules();
  void Join();
  void AwaitParticipants();
  void ShowToRos();
  void Spawn();
  void Loop();
  void OnSignal(int signal);
  bool GoesOnWithoutAgents() const { return experiment_.run.on_agent_loss != OnAgentLoss::kAbort; }
  void Reap();
  bool HearHosts();
  void AwaitChildren();
  void CheckWire();
  void TellLosses();
  void LookAtFleet();
  void SteerFleet();
  void BringDown();
  bool IsOfFile(const Event& event) const;
  void TellLossBy(const Event& event);
  bool HaveHeardAllFrom(AgentRange agents) const;
  void SayFarewell(const std::string& process) const;
  void StartAfresh();
  void StartAfresh(AgentRange agents, std::int64_t tick);
  void Remind();
  WallClock::duration BetweenReminders() const;
  void Steer();
  RunPhases::View Record();
  RunPhases::View Look() const;
  void Do(const RunPhases::Actions& actions);
  double Pace() const;
  void AskToEnd();
  void CallLibrary(const std::function<void()>& call);
  std::optional<RunLinks::Status> ServerReport() const;
  void DrainAll();
  void AwaitReport();
  void Collect();
  std::vector<Event> UnansweredAtLast() const;
  void TakeReport();
  void AwaitAgentsByHand();
  void LeaveDomain();

  const Experiment& experiment_;
  RunRequests* const run_requests_;  // may be null
  Console& console_;
  StopSignal& stop_;
  RosSource* const ros_;
  ActionSource* const action_source_;  // may be null
  Stepper* const stepper_;             // may be null
  const WallClock::time_point launched_ = WallClock::now();
  WallClock::time_point next_reminder_ = launched_ + BetweenReminders();
  std::vector<std::pair<AgentRange, std::string>> losses_;  // of which no event tells yet: agents, and what happened
  std::size_t seen_events_ = 0;                             // of those that the recorder has
  /// The newest event that has lost an agent.
  struct LostBy {
    std::int64_t tick = 0;
    bool is_of_file = false;
  };
  std::map<int, LostBy> lost_by_;                              // agent -> event
  std::vector<std::string> dead_;                              // processes for which to say farewell
  std::map<std::string, std::vector<std::string>> arguments_;  // of the processes of agents on this host
  int next_number_ = kFirstAgents;  // DomainOptions::number of the next process that starts afresh
  /// A process that was started afresh.
  struct Start {
    std::int64_t tick = -1;
    int times = 0;  ///< at this tick
    bool runs = false;
  };
  std::map<AgentRange, Start> started_;         // the newest
  std::map<std::string, std::string> by_hand_;  // processes that are started by hand: what to type
  EngineResult result_;
  std::int64_t confirmed_ = 0;        // rows recorded so far
  std::uint32_t request_number_ = 0;  // number of the newest request to the physics server
  bool is_asked_ = false;             // it is that of the order that run_requests_ has now

  RunLayout layout_;
  const RunFolder& folder_;
  std::optional<DomainLock> lock_;
  std::optional<Janitor> janitor_;
  std::optional<RunCredentials> credentials_;           // with network.security
  std::shared_ptr<const Credentials> own_credentials_;  // of the orchestrator
  std::pair<std::string, std::string> last_words_;      // a file, and what it gets if we are killed
  bool joins_ = false;                                  // this process has begun to join the domain
  bool library_hangs_ = false;
  bool is_killed_ = false;  // its processes
  ChildLogs logs_;
  Children children_;
  Peers peers_;
  std::optional<Launcher> launcher_;  // if there are other hosts
  WireAudit audit_;
  std::optional<Domain> discovery_server_;
  std::optional<Domain> domain_;
  std::optional<RunLinks> links_;
  Fleet fleet_;
  std::optional<FleetLinks> fleet_links_;
  bool vehicles_are_there_ = false;  // all of them, once
  RowFeed feed_;
  std::optional<Recorder> recorder_;
  std::optional<ActionSender> actions_;  // if agents take some, or somebody steps the run
  std::optional<RosPublisher> ros_publisher_;
  RunPhases phases_;
};

DdsRun::DdsRun(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
               RunRequests* requests, Console& console, StopSignal& stop, RosSource* ros, ActionSource* actions,
               Stepper* stepper)
    : experiment_(experiment),
      run_requests_(requests),
      console_(console),
      stop_(stop),
      ros_(ros),
      action_source_(stepper != nullptr ? stepper : actions),
      stepper_(stepper),
      layout_(experiment),
      folder_(folder),
      logs_([this](const std::string& process,
                   const std::string& line) { console_.ChildLine(layout_.PlacedName(process), line); },
            [this](const std::string& words) { console_.Warning(words); }),
      children_(logs_),
      audit_(experiment, peers_),
      fleet_(experiment),
      feed_(experiment, sinks),
      phases_(Rules(), launched_) {}

RunPhases::Rules DdsRun::Rules() {
  const auto& run = experiment_.run;
  return {.start_timeout_s = run.start_timeout_s,
          .agent_timeout_s = run.agent_timeout_s,
          .period_s = run.mode == Mode::kRealtime ? experiment_.period_s() / run.speed : 0,
          .violation = [this] { return audit_.Violation(); },
          .missing = [this] { return links_->Missing(); },
          .lacking = [this] { return recorder_->Lacking(); },
          .waits_for_people = [this] { return !fleet_.empty() && phases_.phase() == RunPhases::Phase::kStarting; },
          .is_loss =
              [this](const std::string& process) {
                return VehicleOf(process) || (GoesOnWithoutAgents() && AgentsOf(process));
              },
          .last_lines = [this](const std::string& process) { return logs_.LastLines(process); }};
}

void DdsRun::Join() {
  const bool restarts =
      experiment_.run.on_agent_loss == OnAgentLoss::kRestart ||
      std::ranges::any_of(experiment_.events, [](const Event& event) { return event.restart.has_value(); });
  if (restarts && !experiment_.network.is_bundled())
    throw std::runtime_error(
        "network.delivery: expected \"bundled\" or \"auto\" in a run over DDS in which agents start "
        "afresh, got \"topics\"");
  const bool has_words = std::ranges::any_of(experiment_.agents, &AgentConfig::sends_messages);
  if (experiment_.network.is_secure() && !experiment_.network.is_bundled() && layout_.reaches_others() && has_words)
    throw std::runtime_error(
        "network.delivery: expected \"bundled\" or \"auto\" with security = \"graph\", where agents that send messages "
        "are on other hosts or started by hand, got \"topics\"");
  std::set<int> of_vehicles;
  for (const int id : AgentsWithVehicles(experiment_)) of_vehicles.insert(experiment_.agent(id).vehicle->domain);
  lock_.emplace(experiment_.network.domain, of_vehicles);
  if (run_requests_ != nullptr) run_requests_->SetDomain(lock_->domain());
  layout_.SetDomain(lock_->domain(), lock_->discovery_port());
  SweepSharedMemory(lock_->domain());  // left by runs of which also the janitor was killed
  RequireAddresses(OwnOptions());
  RequireResources(
      {.shared_memory = layout_.SharedMemoryOn(""),
       .processes = 2 + layout_.ProcessesOn(""),
       .descriptors = kOwnDescriptors + kDescriptorsPerProcess * static_cast<int>(layout_.processes().size())});
  janitor_.emplace(*lock_);
  if (!last_words_.first.empty()) janitor_->LeaveWords(last_words_.first, last_words_.second);
  if (experiment_.network.is_secure()) {
    credentials_.emplace(experiment_, lock_->domain());
    own_credentials_ = credentials_->Own();
  }
  children_.Share(janitor_->lifeline());
  for (const int descriptor : lock_->descriptors()) children_.Share(descriptor);
  Spawn();
  if (!phases_.in_order()) return;  // a signal came first; End() ends whom Spawn() has started
  joins_ = true;
  LowerPriority();
  auto wake = [this] { stop_.Wake(); };
  if (layout_.with_server()) discovery_server_.emplace(Options("discovery_server", DiscoveryRole::kServer), [] {});
  domain_.emplace(OwnOptions(), wake, &peers_, &audit_);
  peers_.Know(kOrchestrator, ProcessKey::Of(domain_->guid_prefix()));
  if (layout_.is_star()) AwaitParticipants();
  links_.emplace(*domain_, peers_, experiment_,
                 LogFile(folder_.Log("orchestrator"), [this](const std::string& words) { console_.Warning(words); }),
                 wake);
  fleet_links_.emplace(*domain_, experiment_, fleet_, wake);
  recorder_.emplace(*domain_, experiment_, feed_, /*stepped=*/stepper_ != nullptr);
  if (TakesActions(experiment_) || stepper_ != nullptr)
    actions_.emplace(*domain_, experiment_, *recorder_, action_source_, stepper_);
  if (action_source_ != nullptr) action_source_->OnDomain(lock_->domain(), layout_.reaches_others() ? "" : "127.0.0.1");
  if (ros_ != nullptr) ShowToRos();
}

/// Waits for all processes of this host (Domain::AwaitOthers()), but not for those of which one has ended.
void DdsRun::AwaitParticipants() {
  domain_->AwaitOthers(1 + layout_.ProcessesOn(""), /*announces=*/true, [this](std::chrono::nanoseconds time) {
    OnSignal(stop_.Within(time));
    Reap();
    return phases_.in_order();
  });
}

/// Shows the run to RViz2, by a participant of its own: without shared memory, which other versions of Fast DDS may not
/// share with ours, and found without the discovery server. The audit is told what it discovers, which the server may
/// not know.
void DdsRun::ShowToRos() {
  DomainOptions options = Options("ros_view", DiscoveryRole::kPeer);
  options.transport = "udp";
  options.number = -1;
  ros_publisher_.emplace(
      options, *ros_, [this](const std::string& line) { console_.Line(line); },
      layout_.with_server() ? &audit_ : nullptr);
}

/// The options of a participant of this process.
DomainOptions DdsRun::Options(const std::string& name, DiscoveryRole role) const {
  DomainOptions options = layout_.Options(name, role);
  options.credentials = own_credentials_;
  return options;
}

DomainOptions DdsRun::OwnOptions() const {
  return Options(kOrchestrator, layout_.with_server() ? DiscoveryRole::kObserver : DiscoveryRole::kPeer);
}

/// With network.security, makes the credentials of a process that is started now. Returns its arguments for them.
std::vector<std::string> DdsRun::CredentialsFor(const std::string& process) {
  if (!credentials_) return {};
  return {"--credentials", credentials_->Write(credentials_->Issue(process, layout_.RankOf(process))).string()};
}

/// Fits the participants of the newest process of this name, which has this process id. With network.security it proves
/// by its certificate that it is this process.
ProcessKey DdsRun::KeyOf(const std::string& process, pid_t pid) const {
  return credentials_ ? credentials_->KeyOf(process) : ProcessKey::WithPid(pid);
}

std::vector<std::string> DdsRun::ArgumentsOfVehicle(int vehicle) const {
  std::vector<std::string> arguments = ArgumentsOf(experiment_, lock_->domain(), kPeersOfVehicle);
  arguments.insert(arguments.end(), {"--id", std::to_string(vehicle)});
  return arguments;
}

HostJob DdsRun::JobOf(const HostConfig& host, const std::string& our_address) {
  HostJob job;
  job.domain = lock_->domain();
  job.shared_memory = layout_.SharedMemoryOn(host.name);
  job.silence_s = std::max(kHostPatience_s, 2 * experiment_.run.agent_timeout_s);
  const auto add = [&](const std::string& process, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--orchestrator", std::to_string(getpid())});
    if (layout_.with_server())
      arguments.insert(arguments.end(), {"--discovery", layout_.ServerAt(our_address)});
    else
      arguments.insert(arguments.end(), {"--peers-at", our_address});
    if (!host.address.empty()) arguments.insert(arguments.end(), {"--address", host.address});
    job.processes.push_back(
        {process, arguments, credentials_ ? ToText(credentials_->Issue(process, layout_.RankOf(process))) : ""});
    if (credentials_) peers_.Know(process, credentials_->KeyOf(process));
  };
  for (const AgentRange& agents : layout_.processes())
    if (experiment_.agent(agents.first).host == host.name)
      add(ProcessName(agents), ArgumentsOf(experiment_, lock_->domain(), agents));
  for (const int vehicle : layout_.vehicles())
    if (experiment_.agent(vehicle).host == host.name) add(VehicleName(vehicle), ArgumentsOfVehicle(vehicle));
  return job;
}

void DdsRun::Spawn() {
  const DomainOptions options = Options("", DiscoveryRole::kClient);
  std::vector<std::string> common{"--parent", std::to_string(getpid())};
  if (options.loopback) common.push_back("--loopback");
  if (layout_.with_server()) common.insert(common.end(), {"--discovery", options.server});
  console_.Line("DDS domain " + std::to_string(options.domain) +
                (layout_.with_server() ? ", discovery server " + options.server : ""));

  const auto complete = [&common, this](const std::string& process, std::vector<std::string> arguments, int number,
                                        std::ptrdiff_t awaits) {
    arguments.insert(arguments.end(), common.begin(), common.end());
    const std::vector<std::string> credentials = CredentialsFor(process);
    arguments.insert(arguments.end(), credentials.begin(), credentials.end());
    arguments.insert(arguments.end(), {"--participant", std::to_string(number)});
    if (!layout_.is_star()) return arguments;
    arguments.insert(arguments.end(), {"--peers", fmt::format("{}", fmt::join(layout_.PeersOf(process), ",")),
                                       "--awaits", std::to_string(awaits)});
    return arguments;
  };
  const auto spawn_vehicles = [&] {
    for (const int vehicle : layout_.vehicles()) {
      const std::string process = VehicleName(vehicle);
      if (!layout_.HostOf(process).empty()) {
        peers_.Await(process, ProcessKey());  // its host starts it
        continue;
      }
      const pid_t pid =
          children_.Spawn(process, ProgramFolder() / "vehicle",
                          complete(process, ArgumentsOfVehicle(vehicle), layout_.NumberOf(process), kPeersOfVehicle),
                          folder_.Log(process));
      peers_.Know(process, KeyOf(process, pid));
    }
  };
  const pid_t server =
      children_.Spawn(kPhysicsServer, ProgramFolder() / "physics_server",
                      complete(kPhysicsServer, ArgumentsOf(experiment_, options.domain, options.participants),
                               kNumberOfServer, layout_.ProcessesOn("") + 1),
                      folder_.Log(kPhysicsServer));
  peers_.Know(kPhysicsServer, KeyOf(kPhysicsServer, server));
  std::vector<Children::CopyOf> here;
  for (const AgentRange& agents : layout_.processes()) {
    const AgentConfig& agent = experiment_.agent(agents.first);
    const std::string process = ProcessName(agents);
    if (!agent.external && agent.host.empty()) {
      const int number = kFirstAgents + static_cast<int>(here.size());
      here.push_back(
          {process,
           complete(process, ArgumentsOf(experiment_, options.domain, agents), number, 2 + layout_.MatesOf(agents)),
           folder_.Log(process)});
      continue;
    }
    if (!agent.external) {
      peers_.Await(process, ProcessKey());  // its host starts it, and says nothing of its place
      continue;
    }
    const std::vector<std::string> credentials = CredentialsFor(process);
    peers_.Await(process, credentials_ ? credentials_->KeyOf(process) : ProcessKey());
    by_hand_[process] = "agent --id " + IdsText(agents) + " --domain " + std::to_string(options.domain) +
                        (options.transport == DomainOptions().transport ? "" : " --transport " + options.transport) +
                        (layout_.with_server() ? " --discovery " + layout_.ServerAt("THIS-HOST") : "") +
                        (credentials.empty() ? "" : " --credentials " + credentials.back());
    console_.Line("waiting for: " + by_hand_[process]);
  }
  for (const Children::CopyOf& copy : here) arguments_[copy.process] = copy.arguments;
  next_number_ = kFirstAgents + layout_.ProcessesOn("");
  const std::vector<pid_t> ids =
      children_.SpawnCopies(ProgramFolder() / "agent", here, {experiment_.run.start_timeout_s, [this] {
                                                                OnSignal(stop_.Within(0ms));
                                                                return phases_.in_order();
                                                              }});
  for (std::size_t k = 0; k < ids.size(); ++k) peers_.Know(here[k].process, KeyOf(here[k].process, ids[k]));
  spawn_vehicles();
  if (experiment_.hosts.empty() || !phases_.in_order()) return;
  launcher_.emplace(
      experiment_, folder_,
      Launcher::Rules{
          .start_timeout_s = experiment_.run.start_timeout_s,
          .silence_s = std::max(kMinSilence_s, kShareOfTimeout * experiment_.run.agent_timeout_s),
          .goes_on =
              [this] {
                return GoesOnWithoutAgents() && phases_.signal() == 0 && phases_.phase() != RunPhases::Phase::kStarting;
              },
          .job = [this](const HostConfig& host, const std::string& our_address) { return JobOf(host, our_address); }},
      children_, logs_, peers_);
  launcher_->Start();
}

EngineResult DdsRun::Fly() {
  try {
    if (run_requests_ != nullptr) run_requests_->CallWhenAsked([this] { stop_.Wake(); });
    Join();
    Loop();
  } catch (const std::exception& failure) {
    phases_.Fail(InWords(failure));
  }
  try {
    BringDown();
  } catch (const std::exception& failure) {
    phases_.Fail(InWords(failure));
  }
  if (run_requests_ != nullptr) run_requests_->Close();
  if (recorder_) Collect();
  result_.failure = phases_.failure();
  result_.signal = phases_.signal();
  return result_;
}

void DdsRun::Loop() {
  while (phases_.phase() < RunPhases::Phase::kCollecting) {
    OnSignal(stop_.Within(50ms));
    domain_->RethrowFailure();
    Reap();
    links_->HandOutExperiment();
    CheckWire();
    TellLosses();
    LookAtFleet();
    StartAfresh();
    Remind();
    const RunPhases::View view = Record();
    Do(phases_.Look(view, WallClock::now()));
    if (run_requests_ != nullptr && phases_.phase() == RunPhases::Phase::kFlying) Steer();
    if (run_requests_ != nullptr && phases_.phase() != RunPhases::Phase::kFlying && !fleet_.empty()) SteerFleet();
  }
}

/// While the run waits for processes, says now and then for which, and what to type for agents that are started by
/// hand.
void DdsRun::Remind() {
  if (phases_.phase() != RunPhases::Phase::kStarting || WallClock::now() < next_reminder_) return;
  next_reminder_ = WallClock::now() + BetweenReminders();
  if (phases_.found_everybody()) return console_.Line("still waiting: " + fleet_.Awaited());
  console_.Line("still waiting: " + links_->Missing());
  for (const auto& [process, command] : by_hand_)
    if (!links_->StatusOf(process)) console_.Line("waiting for: " + command);
}

/// A reader of the terminal is patient for ten seconds; a run with a short time-out is reminded at least three times.
WallClock::duration DdsRun::BetweenReminders() const {
  return std::chrono::milliseconds(std::lround(1000 * std::min(10.0, experiment_.run.start_timeout_s / 4)));
}

/// Passes an order on to the physics server, and its answer back.
void DdsRun::Steer() {
  run_requests_->Open();
  const auto server = links_->StatusOf(kPhysicsServer);
  if (server && static_cast<Life>(server->state()) == Life::kRunning)
    run_requests_->SetStatus(server->paused(), server->pace());
  SteerFleet();
  const auto order = run_requests_->Next();
  if (!order) return;
  if (order->kind == Request::Kind::kStop) {
    Do(phases_.OnRequestToStop(WallClock::now()));
    return run_requests_->Done(confirmed_);
  }
  if (!std::exchange(is_asked_, true)) ++request_number_;
  if (!server || server->request() != request_number_) return links_->Steer(*order, request_number_);
  const std::int64_t tick = server->request_tick();
  is_asked_ = false;
  if (tick == kTooLate) return run_requests_->CheckAgain();
  run_requests_->Done(tick == kOver ? std::nullopt : std::optional(tick));
}

/// Tells people what has happened to vehicles, and asks of these what follows.
void DdsRun::LookAtFleet() {
  if (fleet_.empty()) return;
  fleet_links_->Pass();
  if (run_requests_ != nullptr) run_requests_->SetVehicles(fleet_.Phases());
  for (const VehicleNews& news : fleet_.TakeNews()) {
    console_.Line(fmt::format("vehicle {}: {}", news.agent, news.words));
    feed_.OnVehicle(news);
  }
  if (phases_.phase() == RunPhases::Phase::kStarting)
    if (const std::string why = fleet_.WhyNotToBegin(); !why.empty()) phases_.Fail("the run cannot begin: " + why);
  if (phases_.phase() == RunPhases::Phase::kStarting && phases_.found_everybody() && fleet_.AreFound() &&
      !std::exchange(vehicles_are_there_, true)) {
    if (run_requests_ != nullptr && run_requests_->vehicles_go())
      console_.Line(fleet_.Start());
    else
      console_.Line("all vehicles are there; they take off when somebody says: orchestrator send start");
  }
  for (const Fleet::Order& order : fleet_.Orders(WallClock::now())) links_->Ask(order);
}

/// Carries out what people ask of vehicles.
void DdsRun::SteerFleet() {
  run_requests_->Open();
  const auto order = run_requests_->Next();
  if (!order) return;
  const int agent = static_cast<int>(order->number);
  const bool is_for_the_landing = order->kind == Request::Kind::kLand || order->kind == Request::Kind::kKill;
  if (phases_.phase() > RunPhases::Phase::kFlying && !is_for_the_landing)
    return run_requests_->Refuse("the run is over");
  try {
    switch (order->kind) {
      case Request::Kind::kStart:
        return run_requests_->Tell(fleet_.Start());
      case Request::Kind::kLand:
        return run_requests_->Tell(fleet_.Land(agent, "asked to land"));
      case Request::Kind::kKill:
        return run_requests_->Tell(fleet_.StopMotors(agent, "asked to"));
      case Request::Kind::kStop:
        if (phases_.phase() != RunPhases::Phase::kStarting) return;  // Steer() does it
        Do(phases_.OnRequestToStop(WallClock::now()));
        return run_requests_->Tell("the run ends before it has begun");
      default:
        if (phases_.phase() == RunPhases::Phase::kStarting)
          run_requests_->Refuse("the run has not begun: " + fleet_.Awaited());
    }
  } catch (const std::invalid_argument& error) {
    run_requests_->Refuse(error.what());
  }
}

/// Before the run ends, vehicles land. A signal within kHurry after another ends that.
void DdsRun::BringDown() {
  constexpr auto kHurry = 3s;
  constexpr auto kLookEvery = 50ms;
  constexpr auto kLongest = 120s;
  if (fleet_.empty() || !fleet_links_) return;
  LookAtFleet();
  if (fleet_.AreDown()) return;
  if (is_killed_) return console_.Line("nothing is sent to vehicles any more: their autopilots decide");
  const auto begin = WallClock::now();
  auto asked_at = begin;
  console_.Line(fleet_.Land(0, phases_.signal() != 0 ? strsignal(phases_.signal()) : "the run ends") +
                " (Ctrl-C within 3 s: nothing is sent any more)");
  while (!fleet_.AreDown() && WallClock::now() < begin + kLongest) {
    const int signal = stop_.Within(kLookEvery);
    const auto now = WallClock::now();
    if (signal != 0 && now < asked_at + kHurry) {
      console_.Line("nothing is sent to vehicles any more: their autopilots decide");
      break;
    }
    if (signal != 0) {
      asked_at = now;
      console_.Line("still landing (Ctrl-C within 3 s: nothing is sent any more)");
    }
    Reap();
    TellLosses();
    LookAtFleet();
    if (run_requests_ != nullptr) SteerFleet();
  }
  if (WallClock::now() >= begin + kLongest)
    console_.Line(
        fmt::format("not all vehicles have landed within {} s: {}; nothing is sent any more, and their "
                    "autopilots decide",
                    kLongest.count(), fleet_.Phases()));
}

void DdsRun::OnSignal(int signal) {
  if (signal == 0) return;
  const RunPhases::Actions actions = phases_.OnSignal(signal, WallClock::now());
  if (actions.ask_to_stop) console_.Line("stopping (once more to kill)");
  Do(actions);
}

/// Passes the exits of processes to RunPhases.
void DdsRun::Reap() {
  std::vector<RunPhases::Exit> exits;
  for (const Exit& exit : children_.Reap())
    if (!launcher_ || !launcher_->OnExit(exit)) exits.push_back({exit.process, exit.code(), exit.Text()});
  if (launcher_) {
    HearHosts();
    for (Launcher::Ended& ended : launcher_->TakeEnded())
      exits.push_back({std::move(ended.process), ended.code, std::move(ended.text)});
  }
  if (phases_.phase() >= RunPhases::Phase::kCollecting)  // phases_ looks at no exit any more, and vehicles land
    for (const RunPhases::Exit& exit : exits)
      if (const auto vehicle = VehicleOf(exit.process)) fleet_.OnProcessEnd(*vehicle, exit.text);
  phases_.OnExits(exits, WallClock::now());
}

/// Returns whether they have told anything.
bool DdsRun::HearHosts() try { return launcher_->Pump(); } catch (const std::exception& failure) {
  phases_.Fail(InWords(failure));
  return false;
}

bool DdsRun::IsOfFile(const Event& event) const {
  return std::ranges::any_of(
      experiment_.events, [&](const Event& other) { return other.tick == event.tick && other.Toml() == event.Toml(); });
}

/// Tells of an agent that hangs, as the physics server has noticed.
void DdsRun::TellLossBy(const Event& event) {
  if (!event.fault || !event.fault->IsLoss()) return;
  const bool is_of_file = IsOfFile(event);
  const int agent = event.fault->agent;
  lost_by_[agent] = {event.tick, is_of_file};
  if (event.fault->kind == FaultKind::kHang && !is_of_file)
    console_.Line(fmt::format("lost: agent {} hangs: no command within run.agent_timeout_s = {} s\n{}", agent,
                              ShortestFloat(experiment_.run.agent_timeout_s), WhatFollowsALoss(experiment_)));
}

/// Whether others have what these agents have sent before they were lost: all have answered the tick of the event.
bool DdsRun::HaveHeardAllFrom(AgentRange agents) const {
  for (int id = agents.first; id <= agents.last; ++id)
    if (const auto event = lost_by_.find(id); event == lost_by_.end() || confirmed_ <= event->second.tick) return false;
  return true;
}

/// A process of this machine has died, perhaps without leaving the domain. Whoever hears the farewell drops what the
/// process has sent and is not taken yet.
void DdsRun::SayFarewell(const std::string& process) const {
  const auto participant = peers_.ParticipantOf(process);
  if (participant && layout_.HostOf(process).empty()) SayFarewellFor(*participant, lock_->domain());
}

/// Tells the physics server which agents have been lost, until an event says so.
void DdsRun::TellLosses() {
  for (const auto& [process, story] : phases_.TakeLosses()) {
    if (const auto vehicle = VehicleOf(process)) {
      fleet_.OnProcessEnd(*vehicle, story.substr(process.size() + 1));
      continue;
    }
    const AgentRange agents = *AgentsOf(process);
    dead_.push_back(process);
    started_[agents].runs = false;             // if it is awaited, another one has to be started
    if (recorder_->AreLost(agents)) continue;  // by an event, which has ended the process
    losses_.push_back({agents, story});
  }
  for (const mascot_msgs::msg::Event& sample : recorder_->Events(seen_events_)) {
    ++seen_events_;
    TellLossBy(FromWire(sample, experiment_.size()));
  }
  std::erase_if(losses_, [this](const auto& loss) {
    if (!recorder_->AreLost(loss.first)) return false;
    if (const auto event = lost_by_.find(loss.first.last); event == lost_by_.end() || !event->second.is_of_file)
      console_.Line("lost: " + loss.second + "\n" + WhatFollowsALoss(experiment_));
    return true;
  });
  for (const auto& [agents, story] : losses_) links_->Lose(agents);
  std::erase_if(dead_, [this](const std::string& process) {
    if (!HaveHeardAllFrom(*AgentsOf(process))) return false;
    SayFarewell(process);
    return true;
  });
}

/// Starts the processes that the physics server awaits, once all events are known before the tick that they will
/// answer. What the processes before them have sent has arrived: the server awaits them when all have answered.
void DdsRun::StartAfresh() {
  const auto server = links_->StatusOf(kPhysicsServer);
  if (!server || server->awaited().empty()) return;
  const auto tick = static_cast<std::int64_t>(server->tick()) + 1;
  const auto is_started = [&](AgentRange agents) {
    const Start& start = started_[agents];
    return start.tick == tick && start.runs;
  };
  std::vector<AgentRange> awaited;
  for (const std::uint32_t first : server->awaited()) {
    const auto process = std::ranges::find(layout_.processes(), static_cast<int>(first), &AgentRange::first);
    if (process != layout_.processes().end() && !is_started(*process)) awaited.push_back(*process);
  }
  if (awaited.empty()) return;
  std::vector<mascot_msgs::msg::Event> events = recorder_->Events();
  if (std::cmp_less(events.size(), server->events())) return;
  for (const AgentRange& agents : awaited) {
    children_.Kill(ProcessName(agents));
    SayFarewell(ProcessName(agents));
    audit_.OnEnd(ProcessName(agents));
  }
  links_->HandOutExperiment(tick, std::move(events));
  for (const AgentRange& agents : awaited) StartAfresh(agents, tick);
}

void DdsRun::StartAfresh(AgentRange agents, std::int64_t tick) {
  const std::string process = ProcessName(agents);
  const auto known = arguments_.find(process);
  if (known == arguments_.end())
    throw std::runtime_error(
        fmt::format("{} cannot start afresh: this host has not started it", layout_.PlacedName(process)));
  Start& start = started_[agents];
  if (start.tick == tick && start.times == kMaxStarts)
    throw std::runtime_error(
        fmt::format("{} was started afresh {} times at {} s, and has ended each time before it was "
                    "ready",
                    process, kMaxStarts, ShortestFloat(experiment_.time_s(tick))));
  start = {.tick = tick, .times = start.tick == tick ? start.times + 1 : 1, .runs = true};
  std::erase_if(losses_, [agents](const auto& loss) { return loss.first == agents; });
  std::vector<std::string> arguments = known->second;
  // Not the number of a process before it, as long as there are others: with network.transport = "shm", others still
  // write into the memory behind the ports of that.
  *std::next(std::ranges::find(arguments, "--participant")) = std::to_string(next_number_);
  next_number_ = next_number_ + 1 < kNumberOfOrchestrator ? next_number_ + 1 : kFirstAgents;
  if (credentials_)
    *std::next(std::ranges::find(arguments, "--credentials")) =
        credentials_->Write(credentials_->Issue(process, layout_.RankOf(process))).string();
  arguments.insert(arguments.end(), {"--from-tick", std::to_string(tick)});
  peers_.Know(process, [&] {  // on a busy machine it may announce itself before we go on
    return KeyOf(process, children_.Spawn(process, ProgramFolder() / "agent", arguments,
                                          folder_.Log(process + "_from_tick_" + std::to_string(tick))));
  });
  console_.Line(fmt::format("{} starts afresh at {} s", process, ShortestFloat(experiment_.time_s(tick))));
}

void DdsRun::CheckWire() {
  if (const std::string violation = audit_.Violation(); !violation.empty()) phases_.OnViolation(violation);
}

/// Records the complete rows and confirms them to the server; then agents get their actions. Returns the state of the
/// run afterwards.
RunPhases::View DdsRun::Record() {
  const auto server = links_->StatusOf(kPhysicsServer);  // before draining: all samples up to its tick have been sent
  const bool done = server && static_cast<Life>(server->state()) == Life::kDone;
  if (done) recorder_->Settle();
  const bool give_up = phases_.gives_up(WallClock::now());
  const std::int64_t rows = recorder_->Drain(give_up);
  if (actions_) actions_->Send(rows);
  if (rows > confirmed_) links_->Confirm(rows);
  confirmed_ = rows;
  RunPhases::View view = Look();
  view.gave_up = give_up;
  if (done) view.last_tick = static_cast<std::int64_t>(server->tick());
  return view;
}

RunPhases::View DdsRun::Look() const {
  const bool starting = phases_.phase() == RunPhases::Phase::kStarting;
  return {.everybody_found = starting && recorder_->Matched() && fleet_links_->Matched() &&
                             (!actions_ || actions_->Matched()) && audit_.IsComplete() && links_->HaveTheExperiment(),
          .newest_tick = recorder_->newest_tick(),
          .rows = confirmed_,
          .last_tick = {},
          .server_words = links_->server_words(),
          .reported = ServerReport().has_value()};
}

void DdsRun::Do(const RunPhases::Actions& actions) {
  if (actions.say_ready && fleet_.AreReady())
    links_->SayReady(Pace(), run_requests_ != nullptr && run_requests_->status().paused);
  if (actions.ask_to_stop && links_)  // else nobody can be asked yet: processes are being started
    links_->Ask(Ask::kStop, phases_.signal() != 0 ? strsignal(phases_.signal()) : "asked to stop");
  if (actions.ask_to_end) AskToEnd();
  is_killed_ = is_killed_ || actions.kill;
  if (actions.kill && launcher_) launcher_->Kill();
  if (actions.kill) children_.Kill();
}

/// Simulated seconds a second to begin with; without RunRequests, lockstep goes as fast as it can.
double DdsRun::Pace() const {
  if (run_requests_ != nullptr) return run_requests_->status().pace;
  return experiment_.run.mode == Mode::kRealtime ? experiment_.run.speed : 0;
}

void DdsRun::AskToEnd() {
  CallLibrary(
      [this] { links_->Ask(Ask::kEnd, phases_.in_order() ? "done" : std::string(CutUtf8(phases_.failure(), 1000))); });
}

/// Calls the DDS library once the run is over. If it fails or hangs, End() still stops the processes with signals.
void DdsRun::CallLibrary(const std::function<void()>& call) try {
  if (library_hangs_ || ReturnsWithin(kLibraryGrace, call, stop_)) return;
  library_hangs_ = true;
  console_.Line("orchestrator: the DDS library does not end: leaving by force");
} catch (const std::exception& failure) {
  console_.Line(InWords(failure));
}

/// The physics server's last status, with what it measured in the run; nothing before the server has sent it.
std::optional<RunLinks::Status> DdsRun::ServerReport() const {
  auto server = links_->StatusOf(kPhysicsServer);
  if (recorder_->newest_tick() < 0 || !server || !IsLast(static_cast<Life>(server->state()))) return std::nullopt;
  return server;
}

/// Records all remaining rows, also incomplete ones; a signal stops it, since a slow law makes rows slow.
void DdsRun::DrainAll() {
  for (std::int64_t rows = -1; rows != confirmed_;) {
    rows = confirmed_;
    confirmed_ = recorder_->Drain(/*give_up=*/true);
    if (const int signal = stop_.Within(0ms); signal != 0) return OnSignal(signal);
  }
}

void DdsRun::AwaitReport() {
  for (Do(phases_.Collected(Look(), WallClock::now())); phases_.phase() == RunPhases::Phase::kReporting;) {
    OnSignal(stop_.Within(10ms));
    Reap();  // asked to end, processes exit now
    Do(phases_.Look(Look(), WallClock::now()));
  }
}

/// Records what is left and collects the results, whether or not the run ended in order.
void DdsRun::Collect() {
  try {
    DrainAll();
  } catch (const std::exception& failure) {
    phases_.Fail(InWords(failure));
  }
  result_.lost = recorder_->lost();
  result_.unanswered = UnansweredAtLast();
  CheckWire();
  const bool violated = !audit_.Violation().empty();
  if (violated || phases_.found_everybody()) result_.wire_matches_graph = !violated;
  if (recorder_->newest_tick() >= 0) {
    result_.wall_s = recorder_->wall_s();
    result_.startup_s = std::chrono::duration<double>(recorder_->started() - launched_).count();
  }
  AwaitReport();
  TakeReport();
}

/// EngineResult::unanswered
std::vector<Event> DdsRun::UnansweredAtLast() const {
  std::vector<Event> losses;
  for (const mascot_msgs::msg::Event& sample : recorder_->Events()) {
    Event event = FromWire(sample, experiment_.size());
    if (event.tick == confirmed_ && event.fault && event.fault->unanswered && !IsOfFile(event))
      losses.push_back(std::move(event));
  }
  return losses;
}

void DdsRun::TakeReport() {
  const auto server = ServerReport();
  if (!server) return;
  Pacing pacing;
  Contacts contacts;
  try {
    FromWire(*server, experiment_.size(), experiment_.physics.obstacles.size(), experiment_.ticks(), pacing, contacts);
  } catch (const std::exception& failure) {
    return phases_.Fail(InWords(failure));
  }
  result_.contacts = std::move(contacts);
  if (experiment_.run.mode == Mode::kRealtime) result_.pacing = std::move(pacing);
}

bool DdsRun::End(bool process_goes_on) {
  if (links_) AskToEnd();
  const bool others = launcher_ && launcher_->End();
  if (phases_.in_order() || others) AwaitChildren();
  children_.Stop(2s);
  KillDescendants({janitor_ ? janitor_->process() : 0});
  const bool is_half_made = joins_ && !domain_;
  CallLibrary([this] { AwaitAgentsByHand(); });
  // A process that was killed may have kept the lock of our queue in shared memory. Fast DDS 2.9 replaces the queue
  // then, in another thread, and crashes if it is leaving the domain at that time, because leaving waits for the lock.
  const bool may_crash = domain_ && TransportOf(experiment_) != "udp" && children_.killed_at();
  const bool leaves = process_goes_on || !may_crash;
  while (leaves && may_crash && WallClock::now() < *children_.killed_at() + kQueueHeals && stop_.Within(20ms) == 0)
    continue;
  if (leaves)
    CallLibrary([this] { LeaveDomain(); });
  else
    SayFarewellFor(domain_->guid_prefix(), lock_->domain());
  if (library_hangs_ || !leaves) return false;  // the janitor sweeps: this process still has its participant
  if (is_half_made) return true;  // a participant that failed to join has files open until our end: the janitor sweeps
  if (lock_) SweepSharedMemory(lock_->domain());
  SweepPrivateFolders();  // of processes that were killed
  if (janitor_) janitor_->Dismiss();
  return true;
}

/// Waits until the children have exited by themselves. Until then other hosts tell what their processes still print. A
/// signal ends the wait.
void DdsRun::AwaitChildren() {
  const auto begin = WallClock::now();
  auto deadline = begin + kExitGrace;
  while (!children_.WaitAll(20ms) && WallClock::now() < deadline && stop_.Within(0ms) == 0)
    if (launcher_ && HearHosts() && phases_.in_order())
      deadline = std::min(begin + kLastWords, WallClock::now() + kExitGrace);
  if (!launcher_) return;
  HearHosts();
  if (!children_.empty())
    console_.Line("warning: a host has not ended by itself; what its agents printed last may be missing in the logs");
}

/// They are not our children: waits until they have left the domain.
void DdsRun::AwaitAgentsByHand() {
  const auto deadline = WallClock::now() + 2s;
  while (layout_.has_external() && links_ && links_->listeners() > 0 && WallClock::now() < deadline)
    std::this_thread::sleep_for(20ms);
}

void DdsRun::LeaveDomain() {
  ros_publisher_.reset();
  actions_.reset();
  recorder_.reset();
  fleet_links_.reset();
  links_.reset();
  domain_.reset();
  discovery_server_.reset();
}

DdsEngine::DdsEngine(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
                     RunRequests* requests, Console& console, StopSignal& stop, RosSource* ros, ActionSource* actions,
                     Stepper* stepper)
    : run_(std::make_unique<DdsRun>(experiment, folder, sinks, requests, console, stop, ros, actions, stepper)) {}

DdsEngine::~DdsEngine() { End(/*process_goes_on=*/true); }

void DdsEngine::LeaveIfKilled(const std::string& path, const std::string& text) { run_->LeaveIfKilled(path, text); }

EngineResult DdsEngine::Fly() { return run_->Fly(); }

bool DdsEngine::End(bool process_goes_on) {
  if (!run_) return true;
  const bool ended = run_->End(process_goes_on);
  if (!ended) static_cast<void>(run_.release());  // threads of the library use it
  run_.reset();
  return ended;
}

}  // namespace mascot
