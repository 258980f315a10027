#include "orchestrator/engines/dds/rights.h"

#include <algorithm>
#include <functional>
#include <ranges>
#include <stdexcept>

#include "bus/peers.h"
#include "experiment/processes.h"

namespace mascot {
namespace {

/// Whether one of `agents` may hear agent `other`.
bool MayHear(const Experiment& experiment, AgentRange agents, int other) {
  for (int id = agents.first; id <= agents.last; ++id) {
    const auto& heard = experiment.graph.HeardBy(id);
    if (std::ranges::find(heard, other, &Graph::Neighbour::id) != heard.end()) return true;
  }
  return false;
}

/// Whether the physics server reads such topics.
bool ServerReads(TopicKind kind) {
  switch (kind) {
    case TopicKind::kAnswers:
    case TopicKind::kCommand:
    case TopicKind::kExperiment:
    case TopicKind::kMeasured:
    case TopicKind::kRequest:
    case TopicKind::kStatus:
      return true;
    default:
      return false;
  }
}

}  // namespace

bool VehicleReads(const Experiment& experiment, int agent, const Topic& topic) {
  switch (topic.kind) {
    case TopicKind::kAnswers:
      return experiment.network.is_bundled() && topic.agents().Holds(agent);
    case TopicKind::kCommand:
      return !experiment.network.is_bundled() && topic.agent == agent;
    case TopicKind::kExperiment:
    case TopicKind::kRequest:
      return true;
    default:
      return false;
  }
}

namespace {

bool MayRead(const Experiment& experiment, std::string_view process, const Topic& topic) {
  if (process == kOrchestrator) return true;  // it records
  if (process == kPhysicsServer) return ServerReads(topic.kind);
  if (const auto vehicle = VehicleOf(process)) return VehicleReads(experiment, *vehicle, topic);
  const auto agents = AgentsOf(process);
  return agents && MayHave(experiment, *agents, topic, /*reads=*/true);
}

bool MayWriteIn(const Experiment& experiment, std::string_view process, const Topic& topic) {
  if (!MayWrite(process, topic)) return false;
  const auto agents = AgentsOf(process);
  return !agents || MayHave(experiment, *agents, topic, /*reads=*/false);
}

/// The topics of one kind.
std::vector<Topic> TopicsOf(const Experiment& experiment, TopicKind kind) {
  std::vector<Topic> topics;
  const TopicTraits& traits = TraitsOf(kind);
  if (traits.per_agent) {
    for (const AgentConfig& agent : experiment.agents) topics.push_back({.kind = kind, .agent = agent.id});
  } else if (traits.per_process) {
    for (const AgentRange& agents : AgentProcesses(experiment))
      topics.push_back({.kind = kind, .agent = agents.first, .last = agents.last});
  } else {
    topics.push_back({.kind = kind});
  }
  return topics;
}

}  // namespace

bool MayHave(const Experiment& experiment, AgentRange agents, const Topic& topic, bool reads) {
  const bool own = agents.Holds(topic.agent);
  const bool bundled = experiment.network.is_bundled();
  switch (topic.kind) {
    case TopicKind::kAnswers:
      return !reads && bundled && topic.agents() == agents;
    case TopicKind::kBundle:
      return reads && bundled && topic.agents() == agents;
    case TopicKind::kAction:
      return reads && own && experiment.agent(topic.agent).takes_actions;
    case TopicKind::kState:
      return reads && !bundled && (own || MayHear(experiment, agents, topic.agent));
    case TopicKind::kCommand:
      return !reads && !bundled && own;
    case TopicKind::kMessage:
      return !bundled && (reads ? MayHear(experiment, agents, topic.agent) : own) &&
             experiment.agent(topic.agent).sends_messages;
    case TopicKind::kClock:
      return reads && !bundled;
    case TopicKind::kEvent:
    case TopicKind::kExperiment:
      return reads;
    case TopicKind::kRequest:
      return true;
    case TopicKind::kStatus:
      return !reads;
    case TopicKind::kMeasured:
    case TopicKind::kRow:
    case TopicKind::kOdom:
    case TopicKind::kScene:
    case TopicKind::kTf:  // all agents are on them
    case TopicKind::kVehicle:
      return false;
  }
  return false;
}

bool IsOfTheRun(const Experiment& experiment, const Topic& topic) {
  const TopicTraits& traits = topic.traits();
  if (traits.writer == TopicWriter::kVehicle &&
      !(topic.agent <= experiment.size() && experiment.agent(topic.agent).vehicle))
    return false;
  return traits.is_on_wire && (experiment.network.ros_view || !traits.is_for_ros);
}

Rights RightsOf(const Experiment& experiment, std::string_view process) {
  Rights rights;
  for (int kind = 0; kind <= static_cast<int>(TopicKind::kVehicle); ++kind)
    for (const Topic& topic : TopicsOf(experiment, static_cast<TopicKind>(kind))) {
      if (!IsOfTheRun(experiment, topic)) continue;
      if (MayRead(experiment, process, topic)) rights.reads.push_back(topic);
      if (MayWriteIn(experiment, process, topic)) rights.writes.push_back(topic);
    }
  return rights;
}

}  // namespace mascot
