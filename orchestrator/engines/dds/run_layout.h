#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bus/qos.h"
#include "experiment/experiment.h"

namespace mascot {

/// DomainOptions::number of the first process of agents that a host starts; those after it count on.
inline constexpr int kFirstAgents = 3;
/// DomainOptions::participants of the process of a vehicle: the heads of the run and its agent's process.
inline constexpr int kPeersOfVehicle = 3;

/// Where the processes of a run over DDS are, and how they find each other.
///
/// In a star, every process announces itself to the orchestrator and the physics server only: others have nothing to
/// tell each other, but where messages have topics of their own. Many processes, and those of several hosts, find each
/// other by a discovery server. Else they find each other by multicast.
class RunLayout {
 public:
  explicit RunLayout(const Experiment& experiment);

  /// Fixes the domain of the run, and the port of its discovery server if it has one: the functions below that need
  /// them, all that return DomainOptions or bytes, are called afterwards. Throws std::runtime_error if other programs
  /// have ports in this domain that network.security relies on.
  void SetDomain(int domain, int discovery_port);

  /// The agents of each process, in increasing id.
  const std::vector<AgentRange>& processes() const { return processes_; }
  /// The agents with a vehicle, in increasing id; each vehicle has a process on its agent's host.
  const std::vector<int>& vehicles() const { return vehicles_; }
  bool has_external() const { return external_; }          ///< some agents are started by hand
  bool reaches_others() const { return reaches_others_; }  ///< agents may be on other hosts
  bool is_star() const { return is_star_; }
  bool with_server() const { return with_server_; }  ///< a discovery server

  /// The options of a participant of the orchestrator, without credentials.
  DomainOptions Options(const std::string& name, DiscoveryRole role) const;
  /// "IP-ADDRESS:PORT" of the discovery server, for processes that reach this host at `address`.
  std::string ServerAt(const std::string& address) const;

  /// Processes of agents and vehicles on a host that its orchestrator starts; "": on this one.
  int ProcessesOn(const std::string& host) const;
  /// Bytes of /dev/shm that the processes of the run on a host take together; "": on this one.
  std::uint64_t SharedMemoryOn(const std::string& host) const;

  /// The host of a process, if that is another one than this; else empty.
  std::string HostOf(const std::string& process) const;
  /// The name of a process with its host behind it, if that is another one: agent_3@lab1.
  std::string PlacedName(const std::string& process) const;
  /// DomainOptions::number of a process of agents or of a vehicle on this host; those of agents come first.
  int NumberOf(const std::string& process) const;
  /// Where a process is in the order of GUIDs; see kMaxRank.
  int RankOf(const std::string& process) const;
  /// How many processes of this host exchange messages with that of these agents.
  std::ptrdiff_t MatesOf(AgentRange agents) const;
  /// In a star, the numbers of the processes of this host to which a process announces itself; with its own, which does
  /// not count.
  std::vector<int> PeersOf(const std::string& process) const;

 private:
  bool MayBeStar() const;
  bool NeedsServer() const;
  bool HaveWords(AgentRange one, AgentRange other) const;
  /// Whether the process of these agents is started by the orchestrator of this host.
  bool IsStartedOn(const std::string& host, AgentRange agents) const;
  int VehiclesOn(const std::string& host) const;
  /// The process of an agent.
  AgentRange ProcessWith(int agent) const;

  const Experiment& experiment_;
  const std::vector<AgentRange> processes_;
  const std::vector<int> vehicles_;
  const bool external_, reaches_others_;
  bool is_star_, with_server_;
  int domain_ = 0, discovery_port_ = 0;
};

}  // namespace mascot
