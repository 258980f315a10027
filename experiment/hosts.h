#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/agent_range.h"
#include "experiment/toml/section.h"

namespace mascot {

struct AgentConfig;

/// A machine that has some of the agents, beside the one that has the physics server.
struct HostConfig {
  std::string name;
  std::vector<AgentRange> agents;
  std::vector<std::string> launch;  ///< runs there what follows it
  std::string program;              ///< path of orchestrator there; empty: as here
  bool together = false;            ///< one launch command starts all hosts that have this, each with its own name
  std::string address;              ///< IPv4 address of the interface that DDS uses there; empty: the system chooses

  /// Whether it is this machine, by its address.
  bool is_here() const { return address.starts_with("127."); }
};

/// The rows of a table of `hosts`.
std::span<const Key> HostKeys();
/// Reads `hosts` of an experiment file, and notes at each agent on which it is. `agents` empty: their number is
/// unknown.
std::vector<HostConfig> ReadHosts(Section& document, std::vector<AgentConfig>& agents);

}  // namespace mascot
