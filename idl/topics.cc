#include "idl/topics.h"

#include "base/number.h"

namespace mascot {
namespace {

// In the order of TopicKind. The samples in answers, bundles and rows are recorded as those of the topics that they
// stand for.
constexpr TopicTraits kKinds[] = {
    {.kind = TopicKind::kAction,
     .name = "action",
     .per_agent = true,
     .type = "mascot_msgs/msg/AgentAction",
     .writer = TopicWriter::kOrchestrator,
     .rhythm = TopicRhythm::kAnswer,
     .writer_depth = kHistoryDepth,
     .reader_depth = 8,
     .is_recorded = true},
    {.kind = TopicKind::kAnswers,
     .name = "answers",
     .per_process = true,
     .type = "mascot_msgs/msg/Answers",
     .writer = TopicWriter::kAgent,
     .rhythm = TopicRhythm::kTick,
     .writer_depth = 4,
     .reader_depth = 4},
    {.kind = TopicKind::kBundle,
     .name = "bundle",
     .per_process = true,
     .type = "mascot_msgs/msg/Bundle",
     .writer = TopicWriter::kServer,
     .rhythm = TopicRhythm::kTick,
     .writer_depth = 4,
     .reader_depth = 4},
    {.kind = TopicKind::kCommand,
     .name = "command",
     .per_agent = true,
     .type = "mascot_msgs/msg/AgentCommand",
     .writer = TopicWriter::kAgent,
     .rhythm = TopicRhythm::kAnswer,
     .writer_depth = kHistoryDepth,
     .reader_depth = 8,
     .is_recorded = true},
    {.kind = TopicKind::kMessage,
     .name = "message",
     .per_agent = true,
     .type = "mascot_msgs/msg/AgentMessage",
     .writer = TopicWriter::kAgent,
     .rhythm = TopicRhythm::kAnswer,
     .writer_depth = kHistoryDepth,
     .reader_depth = 8,
     .is_recorded = true},
    {.kind = TopicKind::kOdom,
     .name = "odom",
     .per_agent = true,
     .type = "nav_msgs/msg/Odometry",
     .writer = TopicWriter::kOrchestrator,
     .rhythm = TopicRhythm::kTick,
     .writer_depth = 10,
     .reader_depth = 10,
     .is_for_ros = true,
     .is_on_wire = false},
    {.kind = TopicKind::kState,
     .name = "state",
     .per_agent = true,
     .type = "mascot_msgs/msg/AgentState",
     .writer = TopicWriter::kServer,
     .rhythm = TopicRhythm::kTick,
     .writer_depth = kHistoryDepth,
     .reader_depth = 8,
     .is_recorded = true},
    {.kind = TopicKind::kClock,
     .name = "clock",
     .type = "rosgraph_msgs/msg/Clock",
     .writer = TopicWriter::kServer,
     .rhythm = TopicRhythm::kTick,
     .writer_depth = kHistoryDepth,
     .reader_depth = 8,
     .is_recorded = true},
    {.kind = TopicKind::kEvent,
     .name = "event",
     .type = "mascot_msgs/msg/Event",
     .writer = TopicWriter::kServer,
     .rhythm = TopicRhythm::kRare,
     .writer_depth = kHistoryDepth,
     .reader_depth = kHistoryDepth,
     .is_recorded = true},
    {.kind = TopicKind::kExperiment,
     .name = "experiment",
     .type = "mascot_msgs/msg/Experiment",
     .writer = TopicWriter::kOrchestrator,
     .rhythm = TopicRhythm::kRare,
     .writer_depth = 1,
     .reader_depth = 1,
     .for_late_joiners = true,
     .is_large = true},
    {.kind = TopicKind::kRequest,
     .name = "request",
     .type = "mascot_msgs/msg/Request",
     .writer = TopicWriter::kOrchestratorOrServer,
     .rhythm = TopicRhythm::kRare,
     .writer_depth = 32,
     .reader_depth = 32},
    {.kind = TopicKind::kRow,
     .name = "row",
     .type = "mascot_msgs/msg/TickRow",
     .writer = TopicWriter::kServer,
     .rhythm = TopicRhythm::kTick,
     .writer_depth = kHistoryDepth,
     .reader_depth = kHistoryDepth},
    {.kind = TopicKind::kScene,
     .name = "scene",
     .type = "visualization_msgs/msg/MarkerArray",
     .writer = TopicWriter::kOrchestrator,
     .rhythm = TopicRhythm::kRare,
     .writer_depth = 1,
     .reader_depth = 1,
     .for_late_joiners = true,
     .is_large = true,
     .is_for_ros = true},
    {.kind = TopicKind::kStatus,
     .name = "status",
     .type = "mascot_msgs/msg/Status",
     .writer = TopicWriter::kEverybody,
     .rhythm = TopicRhythm::kRare,
     .writer_depth = 256,
     .reader_depth = 256},
    {.kind = TopicKind::kTf,
     .name = "tf",
     .type = "tf2_msgs/msg/TFMessage",
     .writer = TopicWriter::kOrchestrator,
     .rhythm = TopicRhythm::kRare,
     .writer_depth = 10,
     .reader_depth = 10,
     .is_large = true,
     .is_for_ros = true},
    {.kind = TopicKind::kMeasured,
     .name = "measured",
     .per_agent = true,
     .type = "mascot_msgs/msg/AgentState",
     .writer = TopicWriter::kVehicle,
     .rhythm = TopicRhythm::kTick,
     .writer_depth = 1,
     .reader_depth = 1},
    {.kind = TopicKind::kVehicle,
     .name = "vehicle",
     .per_agent = true,
     .type = "mascot_msgs/msg/VehicleStatus",
     .writer = TopicWriter::kVehicle,
     .rhythm = TopicRhythm::kRare,
     .writer_depth = 64,
     .reader_depth = 64,
     .for_late_joiners = true},
};
constexpr std::string_view kAgentPrefix = "agent_";
constexpr std::string_view kAgentsPrefix = "agents_";
constexpr std::string_view kVehiclePrefix = "vehicle_";

/// All of `text` as the number of an agent, 1 or more, as we write it: without sign and leading zeros.
std::optional<int> Number(std::string_view text) {
  const auto number = NumberFrom<int>(text);
  return number >= 1 && text.front() != '0' ? number : std::nullopt;
}

/// The number of an agent behind a prefix.
std::optional<int> NumberBehind(std::string_view prefix, std::string_view name) {
  if (!name.starts_with(prefix)) return std::nullopt;
  name.remove_prefix(prefix.size());
  return name.empty() ? std::nullopt : Number(name);
}

}  // namespace

std::string AgentName(int agent) { return std::string(kAgentPrefix) + std::to_string(agent); }

std::string ProcessName(AgentRange agents) {
  if (agents.first == agents.last) return AgentName(agents.first);
  return std::string(kAgentsPrefix) + std::to_string(agents.first) + "-" + std::to_string(agents.last);
}

std::optional<AgentRange> AgentsOf(std::string_view process) {
  if (const auto agent = NumberBehind(kAgentPrefix, process)) return AgentRange{*agent, *agent};
  const auto dash = process.find('-');
  if (!process.starts_with(kAgentsPrefix) || dash == process.npos || dash == kAgentsPrefix.size() ||
      dash + 1 == process.size())
    return std::nullopt;
  const auto first = Number(process.substr(kAgentsPrefix.size(), dash - kAgentsPrefix.size()));
  const auto last = Number(process.substr(dash + 1));
  return first && last && *first < *last ? std::optional(AgentRange{*first, *last}) : std::nullopt;
}

std::string VehicleName(int agent) { return std::string(kVehiclePrefix) + std::to_string(agent); }

std::optional<int> VehicleOf(std::string_view process) { return NumberBehind(kVehiclePrefix, process); }

const TopicTraits& TraitsOf(TopicKind kind) { return kKinds[static_cast<std::size_t>(kind)]; }

std::string Topic::Name() const {
  const std::string owner = traits().per_agent     ? "/" + AgentName(agent)
                            : traits().per_process ? "/" + ProcessName(agents())
                                                   : "";
  return owner + "/" + std::string(traits().name);
}

std::optional<Topic> Topic::Parse(std::string_view name) {
  if (name.starts_with("rt/")) name.remove_prefix(2);
  if (!name.starts_with('/')) return std::nullopt;
  name.remove_prefix(1);
  const auto slash = name.find('/');
  const bool has_owner = slash != name.npos;
  const AgentRange owner = has_owner ? AgentsOf(name.substr(0, slash)).value_or(AgentRange{}) : AgentRange{};
  if (has_owner) name.remove_prefix(slash + 1);
  for (const TopicTraits& row : kKinds) {
    if (row.name != name || (row.per_agent || row.per_process) != has_owner) continue;
    if (!has_owner) return Topic{.kind = row.kind};
    if (owner.first < 1 || (row.per_agent && owner.size() > 1)) return std::nullopt;
    return Topic{.kind = row.kind, .agent = owner.first, .last = row.per_process ? owner.last : 0};
  }
  return std::nullopt;
}

}  // namespace mascot
