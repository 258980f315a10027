#include "bus/peers.h"

#include <fmt/format.h>

#include <algorithm>

namespace mascot {

bool MayWrite(std::string_view process, const Topic& topic) {
  switch (topic.traits().writer) {
    case TopicWriter::kServer:
      return process == kPhysicsServer;
    case TopicWriter::kAgent: {
      const auto agents = AgentsOf(process);
      return agents && (topic.traits().per_process ? *agents == topic.agents() : agents->Holds(topic.agent));
    }
    case TopicWriter::kOrchestrator:
      return process == kOrchestrator;
    case TopicWriter::kOrchestratorOrServer:  // the server may ask for reports (Lifecycle)
      return process == kOrchestrator || process == kPhysicsServer;
    case TopicWriter::kEverybody:
      return true;
    case TopicWriter::kVehicle:
      return VehicleOf(process) == topic.agent;
  }
  return false;
}

bool HasOneWriter(const Topic& topic) {
  const TopicWriter writer = topic.traits().writer;
  return writer != TopicWriter::kOrchestratorOrServer && writer != TopicWriter::kEverybody;
}

void Peers::Add(const std::string& process, const ProcessKey& key, std::optional<ProcessKey> free) {
  entries_.push_back(
      {.process = process, .key = key, .proof = key.IsOfSubject() ? std::optional(key) : std::nullopt, .free = free});
}

std::string Peers::ProvenProcessOf(const GuidPrefix& participant) const {
  const auto entry =
      std::ranges::find_if(entries_, [&](const Entry& any) { return any.proof && any.proof->Fits(participant); });
  return entry == entries_.end() ? std::string() : entry->process;
}

void Peers::Know(const std::string& process, const ProcessKey& key) {
  const std::lock_guard lock(mutex_);
  Note(process, key);
}

void Peers::Know(const std::string& process, const std::function<ProcessKey()>& start) {
  const std::lock_guard lock(mutex_);
  Note(process, start());
}

void Peers::Note(const std::string& process, const ProcessKey& key) {
  const auto entry = std::ranges::find(entries_, process, &Entry::process);
  if (entry == entries_.end()) {
    Add(process, key, /*free=*/{});
  } else if (key.IsExact()) {
    entry->key = key;
  } else if (key.IsOfAStart() && !key.Fits(entry->key)) {
    entries_.erase(entry);
    Add(process, key, /*free=*/{});
    ++version_;
  }
}

std::vector<Peers::Place> Peers::Places() const {
  const std::lock_guard lock(mutex_);
  std::vector<Place> places;
  for (const Entry& entry : entries_) places.emplace_back(entry.process, entry.key);
  return places;
}

std::uint64_t Peers::version() const {
  const std::lock_guard lock(mutex_);
  return version_;
}

std::optional<std::size_t> Peers::Find(const GuidPrefix& participant, std::string_view name) const {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (!entry.key.IsWildcard() && entry.key.Fits(participant) && (!found || entry.process == name)) found = i;
  }
  return found;
}

std::optional<std::size_t> Peers::FindWriter(const Topic& topic, const GuidPrefix& writer) const {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    // Only the experiment says which participant is the orchestrator, to processes that it has not started.
    const bool fits = entry.key.Fits(writer) && (!entry.key.IsWildcard() || topic.kind == TopicKind::kExperiment);
    if (fits && MayWrite(entry.process, topic)) return i;
  }
  return {};
}

void Peers::Await(const std::string& process, const ProcessKey& key) {
  const std::lock_guard lock(mutex_);
  Add(process, key, /*free=*/key);
}

void Peers::Take(Entry& entry, const GuidPrefix& participant) {
  const bool is_first = !entry.key.IsExact();
  if (entry.free && is_first) ++version_;
  if (!entry.free || is_first) entry.participant = participant;
  entry.key = ProcessKey::Of(participant);
}

std::string Peers::Claim(const GuidPrefix& participant, const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (const auto found = Find(participant, name)) {
    Entry& entry = entries_[*found];
    if (entry.process == name) Take(entry, participant);
    return entry.process;
  }
  for (Entry& entry : entries_)
    if (entry.process == name && entry.key.IsNobody()) {
      Take(entry, participant);
      return name;
    }
  return ProvenProcessOf(participant);
}

void Peers::Leave(const GuidPrefix& participant) {
  const std::lock_guard lock(mutex_);
  for (Entry& entry : entries_)
    if (entry.free && entry.participant == participant) {
      entry.key = *entry.free;
      entry.participant.reset();
      ++version_;
    }
}

void Peers::Vacate(const std::string& process) {
  const std::lock_guard lock(mutex_);
  const auto entry = std::ranges::find(entries_, process, &Entry::process);
  if (entry == entries_.end()) return;
  *entry = {.process = process, .key = {}, .free = ProcessKey()};
  ++version_;
}

std::optional<Peers::GuidPrefix> Peers::ParticipantOf(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  const auto entry = std::ranges::find(entries_, process, &Entry::process);
  return entry == entries_.end() ? std::nullopt : entry->participant;
}

std::string Peers::ProcessOf(const GuidPrefix& participant) const {
  const std::lock_guard lock(mutex_);
  const auto found = Find(participant);
  return found ? entries_[*found].process : ProvenProcessOf(participant);
}

std::vector<std::string> Peers::ProcessesOf(const GuidPrefix& participant) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> processes;
  if (const auto found = Find(participant)) {
    processes.push_back(entries_[*found].process);
    for (std::size_t i = 0; i < entries_.size(); ++i)
      if (const ProcessKey& key = entries_[i].key; i != *found && key.IsExact() && key.Fits(participant))
        processes.push_back(entries_[i].process);
  } else if (std::string proven = ProvenProcessOf(participant); !proven.empty()) {
    processes.push_back(std::move(proven));
  }
  return processes;
}

std::string Peers::WriterOf(const Topic& topic, const GuidPrefix& writer) const {
  const std::lock_guard lock(mutex_);
  const auto found = FindWriter(topic, writer);
  return found ? entries_[*found].process : std::string();
}

std::string Peers::Believe(const Topic& topic, const GuidPrefix& writer) {
  const std::lock_guard lock(mutex_);
  if (const auto found = FindWriter(topic, writer)) {
    entries_[*found].key = ProcessKey::Of(writer);
    return entries_[*found].process;
  }
  ++refused_[{topic, writer}];
  return {};
}

void Peers::RefuseSecond(const Topic& topic, const GuidPrefix& writer) {
  const std::lock_guard lock(mutex_);
  ++seconds_[{topic, writer}];
}

std::vector<std::string> Peers::Refusals() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> lines;
  const auto add = [&](const Counts::value_type& refused, const std::string& why) {
    const auto& [from, samples] = refused;
    lines.push_back(fmt::format("not taken: {} sample{} of {} from {}, {}", samples, samples == 1 ? "" : "s",
                                from.first.Name(), Text(from.second), why));
  };
  for (const auto& refused : refused_)
    if (!FindWriter(refused.first.first, refused.first.second))  // it may have come before we knew its process
      add(refused, "who may not write it");
  for (const auto& refused : seconds_) {
    const auto writer = FindWriter(refused.first.first, refused.first.second);
    add(refused, "a second writer" + (writer ? " of " + entries_[*writer].process : std::string()));
  }
  return lines;
}

}  // namespace mascot
