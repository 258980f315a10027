#include "orchestrator/engines/dds/run_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "bus/addresses.h"
#include "experiment/processes.h"
#include "orchestrator/engines/dds/credentials.h"
#include "orchestrator/engines/dds/delivery.h"

namespace mascot {
namespace {

/// Participants up to which peer-to-peer discovery is used; beyond, a discovery server is faster (50: 2 s, not 5 s).
constexpr int kMaxPeers = 20;
/// Above this number of processes, the ports of a domain do not suffice for a number for each.
constexpr int kMaxNumbered = 110;
/// DomainOptions::number. Programs of others take the lowest that are free: the two by which a star is found have the
/// highest.
constexpr int kDiscoveryNumber = 2, kOwnNumber = kNumberOfOrchestrator, kServersNumber = kNumberOfServer;

}  // namespace

RunLayout::RunLayout(const Experiment& experiment)
    : experiment_(experiment),
      processes_(AgentProcesses(experiment)),
      vehicles_(AgentsWithVehicles(experiment)),
      external_(std::ranges::any_of(experiment.agents, &AgentConfig::external)),
      reaches_others_(external_ || !std::ranges::all_of(experiment.hosts, &HostConfig::is_here)),
      is_star_(MayBeStar()),
      with_server_(!is_star_ && NeedsServer()) {}

/// With network.security, processes find each other without multicast wherever they are, and in the order of their
/// ranks (kMaxRank).
bool RunLayout::MayBeStar() const {
  const bool finds_all = experiment_.network.is_bundled() && experiment_.hosts.empty() && !external_;
  return (finds_all || experiment_.network.is_secure()) && TransportOf(experiment_) != "shm" &&
         ProcessesOn("") <= kMaxNumbered;
}

bool RunLayout::NeedsServer() const {
  return !experiment_.network.is_secure() && (std::ssize(processes_) + 2 > kMaxPeers || !experiment_.hosts.empty());
}

void RunLayout::SetDomain(int domain, int discovery_port) {
  domain_ = domain;
  discovery_port_ = discovery_port;
  if (!is_star_) return;
  // Other DDS programs in the domain, if the file names it, may have the ports on which a star relies.
  for (const int number : {kOwnNumber, kServersNumber}) {
    if (!IsUdpPortInUse(DiscoveryPort(domain_, number))) continue;
    is_star_ = false;
    if (experiment_.network.is_secure())
      throw std::runtime_error(
          fmt::format("network.domain: expected a domain whose ports are free, with security = \"graph\"; in domain {} "
                      "port {} is in use",
                      domain_, DiscoveryPort(domain_, number)));
  }
  with_server_ = with_server_ || (!is_star_ && NeedsServer());
}

DomainOptions RunLayout::Options(const std::string& name, DiscoveryRole role) const {
  DomainOptions options;
  options.domain = domain_;
  options.transport = TransportOf(experiment_);
  options.name = name;
  options.role = role;
  options.number = role == DiscoveryRole::kServer ? kDiscoveryNumber : kOwnNumber;
  options.loopback = !reaches_others_;
  if (is_star_) options.peers = PeersOf(kOrchestrator);
  options.participants = ParticipantsOfServer(experiment_);
  if (with_server_)
    options.server = ServerAt(role == DiscoveryRole::kServer && reaches_others_ ? "0.0.0.0" : "127.0.0.1");
  return options;
}

std::string RunLayout::ServerAt(const std::string& address) const {
  return address + ":" + std::to_string(discovery_port_);
}

int RunLayout::RankOf(const std::string& process) const {
  if (process == kPhysicsServer) return kMaxRank;
  if (const auto vehicle = VehicleOf(process)) return std::max(1, RankOf(ProcessName(ProcessWith(*vehicle))) - 1);
  const auto agents = std::ranges::find(processes_, AgentsOf(process).value_or(AgentRange{}));
  if (experiment_.agent(agents->first).external) return 0;  // it announces itself to all
  return std::max(1, kMaxRank - 2 - static_cast<int>(agents - processes_.begin()));
}

/// Whether the agents of two processes send each other messages on topics of their own.
bool RunLayout::HaveWords(AgentRange one, AgentRange other) const {
  if (experiment_.network.is_bundled()) return false;
  const auto hears = [this](AgentRange listeners, AgentRange speakers) {
    for (int id = listeners.first; id <= listeners.last; ++id)
      for (int heard = speakers.first; heard <= speakers.last; ++heard)
        if (experiment_.agent(heard).sends_messages && experiment_.graph.Hears(id, heard)) return true;
    return false;
  };
  return hears(one, other) || hears(other, one);
}

std::ptrdiff_t RunLayout::MatesOf(AgentRange agents) const {
  return std::ranges::count_if(processes_, [&](const AgentRange& other) {
    return other != agents && IsStartedOn("", other) && HaveWords(agents, other);
  });
}

bool RunLayout::IsStartedOn(const std::string& host, AgentRange agents) const {
  const AgentConfig& agent = experiment_.agent(agents.first);
  return !agent.external && agent.host == host;
}

AgentRange RunLayout::ProcessWith(int agent) const {
  return *std::ranges::find_if(processes_, [agent](AgentRange process) { return process.Holds(agent); });
}

int RunLayout::NumberOf(const std::string& process) const {
  int number = kFirstAgents;
  for (const AgentRange& agents : processes_) {
    if (ProcessName(agents) == process) return number;
    if (IsStartedOn("", agents)) ++number;
  }
  for (const int vehicle : vehicles_) {
    if (VehicleName(vehicle) == process) return number;
    if (experiment_.agent(vehicle).host.empty()) ++number;
  }
  throw std::logic_error(process + " has no number");
}

std::vector<int> RunLayout::PeersOf(const std::string& process) const {
  if (process == kPhysicsServer || process == kOrchestrator)
    return experiment_.network.is_secure() ? std::vector{kServersNumber} : std::vector{kOwnNumber, kServersNumber};
  std::vector<int> peers{kOwnNumber, kServersNumber};
  if (const auto vehicle = VehicleOf(process)) {
    if (const AgentRange agents = ProcessWith(*vehicle); IsStartedOn("", agents))
      peers.push_back(NumberOf(ProcessName(agents)));
  } else if (experiment_.network.is_secure()) {
    for (const AgentRange& other : processes_) {
      if (ProcessName(other) == process) break;
      if (IsStartedOn("", other) && HaveWords(*AgentsOf(process), other)) peers.push_back(NumberOf(ProcessName(other)));
    }
  }
  return peers;
}

std::string RunLayout::HostOf(const std::string& process) const {
  const auto vehicle = VehicleOf(process);
  const auto agents = vehicle ? AgentRange{*vehicle, *vehicle} : AgentsOf(process);
  return agents ? experiment_.agent(agents->first).host : "";
}

std::string RunLayout::PlacedName(const std::string& process) const {
  const std::string host = HostOf(process);
  return host.empty() ? process : process + "@" + host;
}

std::uint64_t RunLayout::SharedMemoryOn(const std::string& host) const {
  DomainOptions options = Options("", DiscoveryRole::kPeer);
  std::uint64_t need = host.empty() ? 2 * SharedMemoryNeeded(options) : 0;  // this process and the physics server
  for (const AgentRange& agents : processes_) {
    if (!IsStartedOn(host, agents)) continue;
    options.participants = ParticipantsOfAgents(experiment_, agents);
    need += SharedMemoryNeeded(options);
  }
  options.participants = kPeersOfVehicle;
  return need + static_cast<std::uint64_t>(VehiclesOn(host)) * SharedMemoryNeeded(options);
}

int RunLayout::ProcessesOn(const std::string& host) const {
  return static_cast<int>(
             std::ranges::count_if(processes_, [&](AgentRange agents) { return IsStartedOn(host, agents); })) +
         VehiclesOn(host);
}

int RunLayout::VehiclesOn(const std::string& host) const {
  return static_cast<int>(
      std::ranges::count_if(vehicles_, [&](int agent) { return experiment_.agent(agent).host == host; }));
}

}  // namespace mascot
