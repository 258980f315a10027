#include "idl/topics.h"

#include <charconv>

namespace mascot {
namespace {

struct KindName {
  TopicKind kind;
  std::string_view name;
  bool per_agent;
};

constexpr KindName kKinds[] = {
    {TopicKind::kCommand, "command", true},
    {TopicKind::kMessage, "message", true},
    {TopicKind::kState, "state", true},
    {TopicKind::kClock, "clock", false},
    {TopicKind::kExperiment, "experiment", false},
    {TopicKind::kRequest, "request", false},
    {TopicKind::kStatus, "status", false},
};
constexpr std::string_view kAgentPrefix = "agent_";

}  // namespace

std::string AgentName(int agent) { return std::string(kAgentPrefix) + std::to_string(agent); }

std::optional<int> AgentNumber(std::string_view name) {
  if (!name.starts_with(kAgentPrefix)) return std::nullopt;
  name.remove_prefix(kAgentPrefix.size());
  int agent = 0;
  const auto [rest, error] = std::from_chars(name.data(), name.data() + name.size(), agent);
  if (error != std::errc{} || rest != name.data() + name.size()) return std::nullopt;
  return agent;
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
    topic.agent = AgentNumber(name.substr(0, slash)).value_or(0);
    if (topic.agent < 1) return std::nullopt;
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
