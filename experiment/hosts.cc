#include "experiment/hosts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string_view>

#include "base/number.h"
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

/// Whether it is an IPv4 address: 192.168.1.11.
bool IsAddress(std::string_view text) {
  constexpr int kParts = 4;
  for (int part = 0; part < kParts; ++part) {
    const std::size_t dot = std::min(text.find('.'), text.size());
    if (!NumberFrom<std::uint8_t>(text.substr(0, dot)) || (dot == text.size()) != (part == kParts - 1)) return false;
    text.remove_prefix(std::min(dot + 1, text.size()));
  }
  return true;
}

std::optional<int> ToId(std::string_view text) {
  const auto id = NumberFrom<int>(text);
  return id > 0 ? id : std::nullopt;
}

/// "1-20" or "1-5,8"; nothing if it is not that, with agents up to `most`.
std::optional<std::vector<AgentRange>> ToRanges(std::string_view text, int most) {
  std::vector<AgentRange> ranges;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(',');
    const std::string_view part = text.substr(0, comma);
    more = comma != text.npos;
    text.remove_prefix(more ? comma + 1 : text.size());
    const std::size_t dash = part.find('-');
    const auto first = ToId(part.substr(0, dash)), last = dash == part.npos ? first : ToId(part.substr(dash + 1));
    if (!first || !last || *first > *last || *last > most) return std::nullopt;
    ranges.push_back({*first, *last});
  }
  return ranges;
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
  const std::string words = section.Text("agents");
  const int most = agents.empty() ? static_cast<int>(kMaxAgents) : static_cast<int>(agents.size());
  if (!section.Wrong("agents")) {
    if (const auto ranges = ToRanges(words, most)) {
      host.agents = *ranges;
      if (!agents.empty()) Place(section, host, agents);
    } else {
      section.Fail("agents",
                   fmt::format("expected agents in 1..{}, such as \"1-20\" or \"1-5,8\", got '{}'", most, words));
    }
  }
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
