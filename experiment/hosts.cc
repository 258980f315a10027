#include "experiment/hosts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>

#include "base/number.h"
#include "experiment/agent_ids.h"
#include "experiment/experiment.h"
#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxHosts = 1000;

/// A name that is a word for ssh and for a file, and no option.
bool IsHostName(const std::string& name) {
  constexpr std::string_view kOthers = "._-@";
  return !name.empty() && name.size() <= 100 && name.front() != '-' && name.front() != '.' &&
         std::ranges::all_of(name, [&](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                  kOthers.find(c) != kOthers.npos;
         });
}

/// Notes at each agent that it is on `host`.
void Place(Section& section, const HostConfig& host, std::vector<AgentConfig>& agents) {
  for (const AgentRange& range : host.agents)
    for (int id = range.first; id <= range.last && !section.Wrong("agents"); ++id) {
      AgentConfig& agent = agents[static_cast<std::size_t>(id - 1)];
      if (!agent.host.empty())
        section.Fail("agents", fmt::format("expected each agent on one host, got agent {} on {} and on {}", id,
                                           agent.host, host.name));
      else if (agent.external)
        section.Fail("agents", fmt::format("expected agents that `up` starts, got agent {}, which is started by hand "
                                           "(agents.override)",
                                           id));
      agent.host = host.name;
    }
}

HostConfig ReadHost(Section& section, std::vector<AgentConfig>& agents, std::set<std::string>& names) {
  HostConfig host;
  host.name = section.Text("name");
  if (!section.Wrong("name") && !IsHostName(host.name))
    section.Fail("name", "expected a host name, got '" + host.name + "'");
  else if (!section.Wrong("name") && !names.insert(host.name).second)
    section.Fail("name", EachOnce("host", host.name));
  const int most = agents.empty() ? static_cast<int>(kMaxAgents) : static_cast<int>(agents.size());
  host.agents = ReadAgentRanges(section, "agents", most);
  if (!agents.empty()) Place(section, host, agents);
  host.launch =
      section.Texts("launch", std::vector<std::string>{"ssh", "-oBatchMode=yes", "-oConnectTimeout=10", host.name});
  if (!section.Wrong("launch") && (host.launch.empty() || host.launch.front().empty()))
    section.Fail("launch", "expected a program and its arguments, got nothing");
  host.together = section.Boolean("together");
  host.program = section.Text("program");
  host.address = section.Text("address");
  if (!section.Wrong("address") && !host.address.empty() && !IsAddress(host.address))
    section.Fail("address", "expected an IPv4 address, got '" + host.address + "'");
  section.Done();
  return host;
}

}  // namespace

bool IsAddress(std::string_view text) {
  constexpr int kParts = 4;
  for (int part = 0; part < kParts; ++part) {
    const std::size_t dot = std::min(text.find('.'), text.size());
    if (!NumberFrom<std::uint8_t>(text.substr(0, dot)) || (dot == text.size()) != (part == kParts - 1)) return false;
    text.remove_prefix(std::min(dot + 1, text.size()));
  }
  return true;
}

std::span<const Key> HostKeys() {
  static const Key keys[] = {
      key::Text("name", "name of the machine").Required(),
      key::Text("agents", "the agents on this machine: \"1-20\" or \"1-5,8\"; all others run where `up` runs")
          .Required(),
      key::Texts("launch", "a command that runs its arguments on the machine")
          .Otherwise("`ssh -oBatchMode=yes -oConnectTimeout=10 NAME`"),
      key::Boolean(
          "together",
          "one launch command starts `orchestrator host` on all such machines at once, hands its standard input to "
          "each, and merges their output; `name` is then Slurm's name of the node, or its own host name")
          .Default("false"),
      key::Text("program", "path of `orchestrator` on the machine; empty: the same as here").Default("\"\""),
      key::Text("address", "IPv4 address of the interface that DDS uses on the machine; empty: the system chooses")
          .Default("\"\""),
  };
  return keys;
}

std::vector<HostConfig> ReadHosts(Section& document, std::vector<AgentConfig>& agents) {
  std::vector<HostConfig> hosts;
  std::set<std::string> names;
  std::vector<Section> sections = FewTables(document, "hosts", kMaxHosts);
  for (Section& section : sections) {
    hosts.push_back(ReadHost(section, agents, names));
    const HostConfig& host = hosts.back();
    const auto other = std::ranges::find_if(hosts, &HostConfig::together);
    if (host.together && (other->launch != host.launch || other->program != host.program))
      section.Fail("launch", "expected the launch command and the program of " + other->name +
                                 ", because they are started together");
  }
  if (!std::ranges::all_of(hosts, &HostConfig::is_here) || std::ranges::any_of(agents, &AgentConfig::external))
    for (std::size_t i = 0; i < hosts.size(); ++i)
      if (hosts[i].is_here())
        sections[i].Fail("address",
                         "expected an address by which agents on other machines reach it, got " + hosts[i].address);
  return hosts;
}

}  // namespace mascot
