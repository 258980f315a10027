#include "orchestrator/engines/dds/wire_audit.h"

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <set>
#include <utility>

#include "base/utf8.h"
#include "experiment/processes.h"
#include "orchestrator/engines/dds/rights.h"

namespace mascot {
namespace {

namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::dds::DomainParticipant;

/// The name of the process that may write `topic`, as error messages say it.
std::string RightfulWriter(const Experiment& experiment, const Topic& topic) {
  if (topic.traits().writer == TopicWriter::kEverybody) return "processes of the run";
  for (const char* process : {kOrchestrator, kPhysicsServer})
    if (MayWrite(process, topic)) return process;
  if (topic.traits().writer == TopicWriter::kVehicle) return VehicleName(topic.agent);
  for (const AgentRange& agents : AgentProcesses(experiment))
    if (agents.Holds(topic.agent)) return ProcessName(agents);
  return AgentName(topic.agent);
}

/// What a participant tells of itself: "process 4711 (ros2) on vm". Fast DDS and Cyclone DDS do, each in its own words.
std::string Whereabouts(const rtps::ParticipantProxyData& participant) {
  std::string process, program, host;
  for (auto it = participant.m_properties.begin(); it != participant.m_properties.end(); ++it) {
    const std::string key = it->first(), value = it->second();
    if (key == "fastdds.physical_data.process" || key == "__Pid") process = "process " + value;
    if (key == "__ProcessName") program = " (" + value + ")";
    if (key == "fastdds.physical_data.host" || key == "__Hostname") host = " on " + value.substr(0, value.find(':'));
  }
  return process + program + host;
}

}  // namespace

void WireAudit::on_participant_discovery(DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  const GuidPrefix& prefix = info.info.m_guid.guidPrefix;
  if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT)
    OnParticipantGone(prefix);
  else
    OnParticipant(prefix, info.info.m_participantName.to_string(), Whereabouts(info.info));
}

void WireAudit::on_subscriber_discovery(DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) {
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER)
    OnEndpointGone(info.info.guid());
  else
    OnEndpoint(info.info.guid(), info.info.topicName().to_string(), /*reads=*/true);
}

void WireAudit::on_publisher_discovery(DomainParticipant*, rtps::WriterDiscoveryInfo&& info) {
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER)
    OnEndpointGone(info.info.guid());
  else
    OnEndpoint(info.info.guid(), info.info.topicName().to_string(), /*reads=*/false);
}

void WireAudit::OnParticipant(const GuidPrefix& participant, const std::string& name, const std::string& whereabouts) {
  const std::lock_guard lock(mutex_);
  const std::string where = name.empty() && whereabouts.empty() ? Text(participant) : PlainLine(whereabouts);
  const Participant& known = participants_[participant] = {PlainLine(name), where, peers_.Claim(participant, name)};
  // Its endpoints may be gone before we are told of them: to call itself so is enough.
  if (known.process.empty() && IsProcess(name))
    Find("two processes say that they are " + name + (where.empty() ? "" : " (" + where + ")"));
}

void WireAudit::Find(const std::string& violation) {
  if (violation_.empty()) violation_ = violation;
}

void WireAudit::OnParticipantGone(const GuidPrefix& participant) {
  const std::lock_guard lock(mutex_);
  participants_.erase(participant);
  peers_.Leave(participant);
}

void WireAudit::OnEnd(const std::string& process) {
  const std::lock_guard lock(mutex_);
  std::erase_if(participants_, [&](const auto& entry) { return entry.second.process == process; });
  std::erase_if(endpoints_, [&](const auto& entry) { return entry.second.owner.process == process; });
}

void WireAudit::OnEndpoint(const Guid& guid, const std::string& dds_topic, bool reads) {
  const auto topic = Topic::Parse(dds_topic);
  if (!topic || !IsOfTheRun(experiment_, *topic)) return;
  const std::lock_guard lock(mutex_);
  const auto known = participants_.find(guid.guidPrefix);
  const Participant self{.name = {}, .whereabouts = {}, .process = peers_.ProcessOf(guid.guidPrefix)};
  const Endpoint& endpoint = endpoints_[guid] = {*topic, reads, known == participants_.end() ? self : known->second};
  Find(ViolationOf(guid, endpoint));
}

void WireAudit::OnEndpointGone(const Guid& guid) {
  const std::lock_guard lock(mutex_);
  endpoints_.erase(guid);
}

std::string WireAudit::Violation() const {
  const std::lock_guard lock(mutex_);
  return violation_;
}

bool WireAudit::IsProcess(const std::string& name) const {
  return std::ranges::any_of(peers_.Places(), [&](const Peers::Place& place) { return place.first == name; });
}

std::string WireAudit::ViolationOf(const Guid& guid, const Endpoint& endpoint) const {
  const auto& [topic, reads, owner] = endpoint;
  const bool is_ours = !owner.process.empty();
  const std::string& process = is_ours ? owner.process : owner.name;  // also of a stranger that calls itself an agent
  const std::string alias = is_ours && !owner.name.empty() && owner.name != process ? " (as '" + owner.name + "')" : "";
  const std::string what = process + alias + (reads ? " reads " : " writes ") + topic.Name();
  if (const auto agents = AgentsOf(process)) {
    const bool exist = agents->first >= 1 && agents->last <= experiment_.size();
    if (!exist && (topic.agent > 0 || !reads))
      return what + ", but there are only agents 1 to " + std::to_string(experiment_.size());
    if (exist && !MayHave(experiment_, *agents, topic, reads)) return what + ", which the graph does not let it";
  }
  const auto vehicle = VehicleOf(process);
  if (vehicle && reads && !VehicleReads(experiment_, *vehicle, topic)) return what + ", which is not of its agent";
  if (reads) return {};
  const auto may_write = [&](const std::string& one) { return MayWrite(one, endpoint.topic); };
  if (!is_ours || !(may_write(process) || std::ranges::any_of(peers_.ProcessesOf(guid.guidPrefix), may_write)))
    return WrongWriter(endpoint);
  const bool twice = HasOneWriter(topic) && std::ranges::any_of(endpoints_, [&](const auto& other) {
                       return other.first != guid && !other.second.reads && other.second.topic == endpoint.topic;
                     });
  return twice ? what + " twice" : "";
}

std::string WireAudit::WrongWriter(const Endpoint& endpoint) const {
  const auto& [topic, reads, owner] = endpoint;
  const std::string where = owner.whereabouts.empty() ? "" : " (" + owner.whereabouts + ")";
  const std::string& name = owner.name.empty() ? owner.process : owner.name;
  return (name.empty() ? "a participant without a name" + where : "'" + name + "'") + " writes " + topic.Name() +
         ", which only " + RightfulWriter(experiment_, topic) + " may" + (name.empty() ? "" : where);
}

bool WireAudit::IsComplete() const {
  const std::lock_guard lock(mutex_);
  std::set<std::pair<AgentRange, Topic>> reading, writing;
  for (const auto& [guid, endpoint] : endpoints_) {
    const auto agents = AgentsOf(endpoint.owner.process);
    if (agents) (endpoint.reads ? reading : writing).emplace(*agents, endpoint.topic);
  }
  const bool bundled = experiment_.network.is_bundled();
  for (const AgentRange& process : AgentProcesses(experiment_)) {
    const auto reads = [&](const Topic& topic) { return reading.contains({process, topic}); };
    const auto writes = [&](const Topic& topic) { return writing.contains({process, topic}); };
    if (bundled && !(reads(Topic::Bundle(process)) && writes(Topic::Answers(process)))) return false;
    for (int id = process.first; id <= process.last; ++id) {
      if (experiment_.agent(id).takes_actions && !reads(Topic::Action(id))) return false;
      if (bundled) continue;
      if (!reads(Topic::State(id)) || !writes(Topic::Command(id))) return false;
      if (experiment_.agent(id).sends_messages && !writes(Topic::Message(id))) return false;
      for (const Graph::Neighbour& heard : experiment_.graph.HeardBy(id)) {
        if (!reads(Topic::State(heard.id))) return false;
        if (experiment_.agent(heard.id).sends_messages && !reads(Topic::Message(heard.id))) return false;
      }
    }
  }
  return true;
}

}  // namespace mascot
