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
    const AgentConfig& agent = experiment_.agent(other.first);
    return other != agents && !agent.external && agent.host.empty() && HaveWords(agents, other);
  });
}

std::vector<int> RunLayout::PeersOf(const std::string& process) const {
  if (!experiment_.network.is_secure()) return {kOwnNumber, kServersNumber};
  if (process == kPhysicsServer || process == kOrchestrator) return {kServersNumber};
  std::vector<int> peers{kOwnNumber, kServersNumber};
  int number = kFirstAgents;
  for (const AgentRange& other : processes_) {
    if (ProcessName(other) == process) break;
    const AgentConfig& agent = experiment_.agent(other.first);
    if (agent.external || !agent.host.empty()) continue;
    if (HaveWords(*AgentsOf(process), other)) peers.push_back(number);
    ++number;
  }
  return peers;
}

std::string RunLayout::HostOf(const std::string& process) const {
  const auto agents = AgentsOf(process);
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
    const AgentConfig& agent = experiment_.agent(agents.first);
    if (agent.external || agent.host != host) continue;
    options.participants = ParticipantsOfAgents(experiment_, agents);
    need += SharedMemoryNeeded(options);
  }
  return need;
}

int RunLayout::ProcessesOn(const std::string& host) const {
  return static_cast<int>(std::ranges::count_if(processes_, [&](const AgentRange& agents) {
    const AgentConfig& agent = experiment_.agent(agents.first);
    return !agent.external && agent.host == host;
  }));
}

}  // namespace mascot
