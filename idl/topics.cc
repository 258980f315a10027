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
    {TopicKind::kCommand, "command", true},        {TopicKind::kMessage, "message", true},
    {TopicKind::kState, "state", true},            {TopicKind::kClock, "clock", false},
    {TopicKind::kExperiment, "experiment", false}, {TopicKind::kRequest, "request", false},
    {TopicKind::kStatus, "status", false},
};
constexpr std::string_view kAgentPrefix = "/agent_";

}  // namespace

std::string Topic::Name() const {
  for (const KindName& row : kKinds)
    if (row.kind == kind)
      return row.per_agent ? std::string(kAgentPrefix) + std::to_string(agent) + "/" + std::string(row.name)
                           : "/" + std::string(row.name);
  return {};
}

std::optional<Topic> Topic::Parse(std::string_view name) {
  if (name.starts_with("rt/")) name.remove_prefix(2);
  Topic topic;
  const bool per_agent = name.starts_with(kAgentPrefix);
  if (per_agent) {
    name.remove_prefix(kAgentPrefix.size());
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), topic.agent);
    if (error != std::errc{} || topic.agent < 1) return std::nullopt;
    name.remove_prefix(static_cast<std::size_t>(end - name.data()));
  }
  if (!name.starts_with('/')) return std::nullopt;
  name.remove_prefix(1);
  for (const KindName& row : kKinds)
    if (row.per_agent == per_agent && row.name == name) {
      topic.kind = row.kind;
      return topic;
    }
  return std::nullopt;
}

}  // namespace mascot
