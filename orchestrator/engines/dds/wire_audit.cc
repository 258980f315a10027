#include "orchestrator/engines/dds/wire_audit.h"

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <optional>
#include <utility>

#include "experiment/processes.h"

namespace mascot {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::dds::DomainParticipant;

/// Whether one of `agents` may hear agent `other`.
bool MayHear(const Experiment& experiment, AgentRange agents, int other) {
  for (int id = agents.first; id <= agents.last; ++id) {
    const auto& heard = experiment.graph.HeardBy(id);
    if (std::ranges::find(heard, other, &Graph::Neighbour::id) != heard.end()) return true;
  }
  return false;
}

/// Whether the process of `agents` may have a reader (`reads`) or writer on `topic`.
bool MayHave(const Experiment& experiment, AgentRange agents, const Topic& topic, bool reads) {
  const bool own = agents.Holds(topic.agent);
  const bool bundled = experiment.network.delivery == Delivery::kBundled;
  switch (topic.kind) {
    case TopicKind::kBundle:
      return reads && own && bundled;
    case TopicKind::kState:
      return reads && !bundled && (own || MayHear(experiment, agents, topic.agent));
    case TopicKind::kCommand:
      return !reads && own;
    case TopicKind::kMessage:
      return (reads ? MayHear(experiment, agents, topic.agent) : own) && experiment.agent(topic.agent).sends_messages;
    case TopicKind::kClock:
    case TopicKind::kExperiment:
      return reads;
    case TopicKind::kRequest:
      return true;
    case TopicKind::kStatus:
      return !reads;
  }
  return false;
}

/// Name of the only process that may write `topic`; empty: any process may.
std::string RightfulWriter(const Experiment& experiment, const Topic& topic) {
  switch (topic.kind) {
    case TopicKind::kBundle:
    case TopicKind::kState:
    case TopicKind::kClock:
      return "physics_server";
    case TopicKind::kCommand:
    case TopicKind::kMessage:
      for (const AgentRange& agents : AgentProcesses(experiment))
        if (agents.Holds(topic.agent)) return ProcessName(agents);
      return AgentName(topic.agent);
    case TopicKind::kExperiment:
      return "orchestrator";
    case TopicKind::kRequest:
    case TopicKind::kStatus:
      return {};
  }
  return {};
}

}  // namespace

void WireAudit::on_participant_discovery(DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  // The name of a participant that has left is kept: its endpoints may be removed later, and are judged until then.
  participants_[info.info.m_guid.guidPrefix] = info.info.m_participantName.to_string();
  news_ = true;
}

void WireAudit::on_subscriber_discovery(DomainParticipant* self, rtps::ReaderDiscoveryInfo&& info) {
  Note(self, info.info.guid(), {info.info.topicName().to_string(), true},
       info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
}

void WireAudit::on_publisher_discovery(DomainParticipant* self, rtps::WriterDiscoveryInfo&& info) {
  Note(self, info.info.guid(), {info.info.topicName().to_string(), false},
       info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
}

void WireAudit::Note(DomainParticipant* self, const Guid& guid, Endpoint endpoint, bool removed) {
  if (guid.guidPrefix == self->guid().guidPrefix) return;  // our own endpoint
  const std::lock_guard lock(mutex_);
  if (removed)
    endpoints_.erase(guid);
  else
    endpoints_[guid] = std::move(endpoint);
  news_ = true;
}

std::string WireAudit::OwnerOf(const Guid& endpoint) const {
  const auto found = participants_.find(endpoint.guidPrefix);
  return found == participants_.end() ? "" : found->second;
}

std::string WireAudit::ViolationOf(const Guid& guid, const Endpoint& endpoint, const Experiment& experiment) const {
  const auto topic = Topic::Parse(endpoint.topic);
  if (!topic) return {};
  const std::string owner = OwnerOf(guid);
  const std::string what = owner + (endpoint.reads ? " reads " : " writes ") + topic->Name();
  if (const auto agents = AgentsOf(owner)) {
    const bool known = agents->first >= 1 && agents->last <= experiment.size();
    if (!known && topic->agent > 0)
      return what + ", but there are only agents 1 to " + std::to_string(experiment.size());
    if (known && !MayHave(experiment, *agents, *topic, endpoint.reads))
      return what + ", which the graph does not let it";
  }
  if (const std::string rightful = RightfulWriter(experiment, *topic);
      !endpoint.reads && !rightful.empty() && owner != rightful)
    return "'" + owner + "' writes " + topic->Name() + ", which only " + rightful + " may";
  return {};
}

std::string WireAudit::Violation(const Experiment& experiment) const {
  const std::lock_guard lock(mutex_);
  std::set<std::pair<std::string, std::string>> writers;
  for (const auto& [guid, endpoint] : endpoints_) {
    if (std::string violation = ViolationOf(guid, endpoint, experiment); !violation.empty()) return violation;
    const auto topic = Topic::Parse(endpoint.topic);
    const bool exclusive = topic && !endpoint.reads && !RightfulWriter(experiment, *topic).empty();
    if (exclusive && !writers.emplace(OwnerOf(guid), endpoint.topic).second)
      return "two processes say that they are " + OwnerOf(guid);
  }
  return {};
}

bool WireAudit::IsComplete(const Experiment& experiment) const {
  const std::lock_guard lock(mutex_);
  std::set<std::pair<AgentRange, Topic>> reading, writing;
  for (const auto& [guid, endpoint] : endpoints_) {
    const auto agents = AgentsOf(OwnerOf(guid));
    const auto topic = Topic::Parse(endpoint.topic);
    if (agents && topic) (endpoint.reads ? reading : writing).emplace(*agents, *topic);
  }
  const bool bundled = experiment.network.delivery == Delivery::kBundled;
  for (const AgentRange& process : AgentProcesses(experiment)) {
    const auto reads = [&](const Topic& topic) { return reading.contains({process, topic}); };
    const auto writes = [&](const Topic& topic) { return writing.contains({process, topic}); };
    for (int id = process.first; id <= process.last; ++id) {
      if (!reads(bundled ? Topic::Bundle(id) : Topic::State(id)) || !writes(Topic::Command(id))) return false;
      if (experiment.agent(id).sends_messages && !writes(Topic::Message(id))) return false;
      for (const Graph::Neighbour& heard : experiment.graph.HeardBy(id)) {
        if (!bundled && !reads(Topic::State(heard.id))) return false;
        if (experiment.agent(heard.id).sends_messages && !reads(Topic::Message(heard.id))) return false;
      }
    }
  }
  return true;
}

}  // namespace mascot
