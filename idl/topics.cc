#include "idl/topics.h"

#include "base/number.h"

namespace mascot {
namespace {

struct KindName {
  TopicKind kind;
  std::string_view name;
  bool per_agent;
};

constexpr KindName kKinds[] = {
    {TopicKind::kBundle, "bundle", true},
    {TopicKind::kCommand, "command", true},
    {TopicKind::kMessage, "message", true},
    {TopicKind::kState, "state", true},
    {TopicKind::kClock, "clock", false},
    {TopicKind::kEvent, "event", false},
    {TopicKind::kExperiment, "experiment", false},
    {TopicKind::kRequest, "request", false},
    {TopicKind::kScene, "scene", false},
    {TopicKind::kStatus, "status", false},
    {TopicKind::kTf, "tf", false},
};
constexpr std::string_view kAgentPrefix = "agent_";
constexpr std::string_view kAgentsPrefix = "agents_";

/// All of `text` as the number of an agent, 1 or more, as we write it: without sign and leading zeros.
std::optional<int> Number(std::string_view text) {
  const auto number = NumberFrom<int>(text);
  return number >= 1 && text.front() != '0' ? number : std::nullopt;
}

std::optional<int> AgentNumber(std::string_view name) {
  if (!name.starts_with(kAgentPrefix)) return std::nullopt;
  name.remove_prefix(kAgentPrefix.size());
  return name.empty() ? std::nullopt : Number(name);
}

}  // namespace

std::string AgentName(int agent) { return std::string(kAgentPrefix) + std::to_string(agent); }

std::string ProcessName(AgentRange agents) {
  if (agents.first == agents.last) return AgentName(agents.first);
  return std::string(kAgentsPrefix) + std::to_string(agents.first) + "-" + std::to_string(agents.last);
}

std::optional<AgentRange> AgentsOf(std::string_view process) {
  if (const auto agent = AgentNumber(process)) return AgentRange{*agent, *agent};
  const auto dash = process.find('-');
  if (!process.starts_with(kAgentsPrefix) || dash == process.npos || dash == kAgentsPrefix.size() ||
      dash + 1 == process.size())
    return std::nullopt;
  const auto first = Number(process.substr(kAgentsPrefix.size(), dash - kAgentsPrefix.size()));
  const auto last = Number(process.substr(dash + 1));
  return first && last && *first < *last ? std::optional(AgentRange{*first, *last}) : std::nullopt;
}

std::string Topic::Name() const {
  for (const KindName& row : kKinds)
    if (row.kind == kind) return (row.per_agent ? "/" + AgentName(agent) : "") + "/" + std::string(row.name);
  return {};
}

std::optional<Topic> Topic::Parse(std::string_view name) {
  if (name.starts_with("rt/")) name.remove_prefix(2);
  if (!name.starts_with('/')) return std::nullopt;
  name.remove_prefix(1);
  Topic topic;
  const auto slash = name.find('/');
  const bool per_agent = slash != name.npos;
  if (per_agent) {
    const auto agent = AgentNumber(name.substr(0, slash));
    if (!agent) return std::nullopt;
    topic.agent = *agent;
    name.remove_prefix(slash + 1);
  }
  for (const KindName& row : kKinds)
    if (row.per_agent == per_agent && row.name == name) {
      topic.kind = row.kind;
      return topic;
    }
  return std::nullopt;
}

}  // namespace mascot
