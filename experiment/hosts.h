#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/agent_range.h"
#include "experiment/toml/section.h"

namespace mascot {

struct AgentConfig;

/// A machine that has some of the agents, besides the machine of the physics server.
struct HostConfig {
  std::string name;
  std::vector<AgentRange> agents;
  std::vector<std::string> launch;  ///< a command that runs its further arguments on the machine
  std::string program;              ///< path of orchestrator on the machine; empty: the same as here
  bool together = false;            ///< one launch command starts all hosts for which this is true
  std::string address;  ///< IPv4 address of the interface that DDS uses on the machine; empty: the system chooses

  /// Whether the address says that the host is this machine.
  bool is_here() const { return address.starts_with("127."); }
};

/// The rows of a table of `hosts`.
std::span<const Key> HostKeys();
/// Reads `hosts` of an experiment file, and sets AgentConfig::host of each agent. `agents` is empty if their number is
/// unknown. Mistakes are noted in `document`.
std::vector<HostConfig> ReadHosts(Section& document, std::vector<AgentConfig>& agents);

/// Whether a text is an IPv4 address.
bool IsAddress(std::string_view text);

}  // namespace mascot
