#pragma once

#include <compare>
#include <optional>
#include <string>
#include <string_view>

#include "experiment/agent_range.h"

namespace mascot {

/// What an agent and its topics go by: "agent_3".
std::string AgentName(int agent);
/// What a process of agents goes by: "agent_3", "agents_1-50".
std::string ProcessName(AgentRange agents);
/// The reverse; nothing for other names.
std::optional<AgentRange> AgentsOf(std::string_view process);

/// What a topic carries. The order is the order of topics of one agent in a recording: by name.
enum class TopicKind { kBundle, kCommand, kMessage, kState, kClock, kExperiment, kRequest, kStatus };

/// Every topic of a run. `agent` is 1..N for the per-agent kinds, else 0.
struct Topic {
  TopicKind kind = TopicKind::kClock;
  int agent = 0;

  static Topic Bundle(int agent) { return {TopicKind::kBundle, agent}; }
  static Topic State(int agent) { return {TopicKind::kState, agent}; }
  static Topic Command(int agent) { return {TopicKind::kCommand, agent}; }
  static Topic Message(int agent) { return {TopicKind::kMessage, agent}; }
  static Topic Clock() { return {TopicKind::kClock, 0}; }
  static Topic Experiment() { return {TopicKind::kExperiment, 0}; }
  static Topic Request() { return {TopicKind::kRequest, 0}; }
  static Topic Status() { return {TopicKind::kStatus, 0}; }

  /// The ROS name: "/agent_3/state", "/clock".
  std::string Name() const;
  /// The DDS name that ROS 2 maps it to: "rt/agent_3/state".
  std::string DdsName() const { return "rt" + Name(); }
  /// The topic of a ROS or DDS name, if it is one of ours.
  static std::optional<Topic> Parse(std::string_view name);

  auto operator<=>(const Topic&) const = default;
};

}  // namespace mascot
