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

/// Name of the process of an agent's vehicle: "vehicle_3".
std::string VehicleName(int agent);
/// The inverse of VehicleName(); nullopt for other names.
std::optional<int> VehicleOf(std::string_view process);

/// What a topic carries. In a recording the topics of one agent are in this order, which is that of their names; those
/// of vehicles, which are not recorded, come last.
enum class TopicKind {
  kAction,
  kAnswers,
  kBundle,
  kCommand,
  kMessage,
  kOdom,
  kState,
  kClock,
  kEvent,
  kExperiment,
  kRequest,
  kRow,
  kScene,
  kStatus,
  kTf,
  kMeasured,
  kVehicle
};

/// Which process may write a topic.
enum class TopicWriter {
  kServer,                ///< the physics server
  kAgent,                 ///< the process of the agent, or of the agents, that the topic is named after
  kOrchestrator,          ///< the orchestrator
  kOrchestratorOrServer,  ///< both: the server asks for reports
  kEverybody,             ///< each process of the run
  kVehicle,               ///< the process of the vehicle of the agent that the topic is named after
};

/// When a topic has a sample.
enum class TopicRhythm {
  kTick,    ///< at each tick
  kAnswer,  ///< with each agent's answer to a tick; in real time an answer may be missing
  kRare,    ///< when something happens
};

/// All that is known of the topics of one kind, but what they carry in C++ (bus/wire.h) and which processes read them
/// (orchestrator/engines/dds/wire_audit.cc).
struct TopicTraits {
  TopicKind kind;
  std::string_view name;     ///< its last word: "state"
  bool per_agent = false;    ///< one for each agent, under the agent's name
  bool per_process = false;  ///< one for each process of agents, under the name of the process
  std::string_view type;     ///< the message type: "mascot_msgs/msg/AgentState"
  TopicWriter writer;
  TopicRhythm rhythm;
  int writer_depth;               ///< samples that a writer keeps
  int reader_depth;               ///< samples that a reader keeps
  bool for_late_joiners = false;  ///< a reader that joins later receives the last sample, too
  bool is_large = false;          ///< a sample may need fragments
  bool is_recorded = false;       ///< run.mcap has it, as it was sent
  bool is_for_ros = false;        ///< only tools of ROS 2 read it (network.ros_view, record.ros_types)
  bool is_on_wire = true;         ///< false: only recordings have it
};

/// The row of a kind in the table of topics.
const TopicTraits& TraitsOf(TopicKind kind);

/// Samples that the writers of recorded topics keep (bundles are not recorded), and their reader in the recorder. The
/// server publishes tick k only after the recorder has confirmed tick k - kRecorderWindow, so no sample is overwritten
/// before it was recorded.
inline constexpr int kHistoryDepth = 128;
inline constexpr int kRecorderWindow = 64;

/// A topic of a run. `agent` is 1..N for the per-agent kinds, the first agent of the process for the per-process kinds,
/// whose last is `last`, else 0.
struct Topic {
  TopicKind kind = TopicKind::kClock;
  int agent = 0;
  int last = 0;

  static Topic Action(int agent) { return {TopicKind::kAction, agent}; }
  static Topic Answers(AgentRange agents) { return {TopicKind::kAnswers, agents.first, agents.last}; }
  static Topic Bundle(AgentRange agents) { return {TopicKind::kBundle, agents.first, agents.last}; }
  static Topic State(int agent) { return {TopicKind::kState, agent}; }
  static Topic Command(int agent) { return {TopicKind::kCommand, agent}; }
  static Topic Message(int agent) { return {TopicKind::kMessage, agent}; }
  static Topic Odom(int agent) { return {TopicKind::kOdom, agent}; }
  static Topic Clock() { return {TopicKind::kClock, 0}; }
  static Topic Event() { return {TopicKind::kEvent, 0}; }
  static Topic Experiment() { return {TopicKind::kExperiment, 0}; }
  static Topic Request() { return {TopicKind::kRequest, 0}; }
  static Topic Row() { return {TopicKind::kRow, 0}; }
  static Topic Scene() { return {TopicKind::kScene, 0}; }
  static Topic Status() { return {TopicKind::kStatus, 0}; }
  static Topic Tf() { return {TopicKind::kTf, 0}; }
  static Topic Measured(int agent) { return {TopicKind::kMeasured, agent}; }
  static Topic Vehicle(int agent) { return {TopicKind::kVehicle, agent}; }

  const TopicTraits& traits() const { return TraitsOf(kind); }
  /// The agents of a topic of a per-process kind.
  AgentRange agents() const { return {agent, last}; }
  /// The ROS name: "/agent_3/state", "/agents_1-50/bundle", "/clock".
  std::string Name() const;
  /// The DDS name that ROS 2 maps it to: "rt/agent_3/state".
  std::string DdsName() const { return "rt" + Name(); }
  /// The topic with this ROS or DDS name; nullopt if it is not one of ours.
  static std::optional<Topic> Parse(std::string_view name);

  auto operator<=>(const Topic&) const = default;
};

}  // namespace mascot
