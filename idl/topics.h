#pragma once

#include <compare>
#include <optional>
#include <string>
#include <string_view>

#include "base/agent_range.h"

namespace mascot {

/// Name of an agent and prefix of its topics: "agent_3".
std::string AgentName(int agent);
/// Name of the process of these agents: "agent_3", "agents_1-50".
std::string ProcessName(AgentRange agents);
/// The inverse of ProcessName(); nullopt for other names.
std::optional<AgentRange> AgentsOf(std::string_view process);

/// What a topic carries. In a recording the topics of one agent are in this order, which is that of their names.
enum class TopicKind {
  kBundle,
  kCommand,
  kMessage,
  kState,
  kClock,
  kEvent,
  kExperiment,
  kRequest,
  kScene,
  kStatus,
  kTf
};

/// A topic of a run. `agent` is 1..N for the per-agent kinds, else 0.
struct Topic {
  TopicKind kind = TopicKind::kClock;
  int agent = 0;

  static Topic Bundle(int agent) { return {TopicKind::kBundle, agent}; }
  static Topic State(int agent) { return {TopicKind::kState, agent}; }
  static Topic Command(int agent) { return {TopicKind::kCommand, agent}; }
  static Topic Message(int agent) { return {TopicKind::kMessage, agent}; }
  static Topic Clock() { return {TopicKind::kClock, 0}; }
  static Topic Event() { return {TopicKind::kEvent, 0}; }
  static Topic Experiment() { return {TopicKind::kExperiment, 0}; }
  static Topic Request() { return {TopicKind::kRequest, 0}; }
  static Topic Scene() { return {TopicKind::kScene, 0}; }
  static Topic Status() { return {TopicKind::kStatus, 0}; }
  static Topic Tf() { return {TopicKind::kTf, 0}; }

  /// The ROS name: "/agent_3/state", "/clock".
  std::string Name() const;
  /// The DDS name that ROS 2 maps it to: "rt/agent_3/state".
  std::string DdsName() const { return "rt" + Name(); }
  /// The topic with this ROS or DDS name; nullopt if it is not one of ours.
  static std::optional<Topic> Parse(std::string_view name);

  auto operator<=>(const Topic&) const = default;
};

}  // namespace mascot
