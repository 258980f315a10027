#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/process_key.h"
#include "idl/topics.h"

namespace mascot {

inline constexpr const char* kOrchestrator = "orchestrator";
inline constexpr const char* kPhysicsServer = "physics_server";

/// Whether a process of a run, by its name, may write this topic.
bool MayWrite(std::string_view process, const Topic& topic);
/// Whether only one process may write this topic, by one writer.
bool HasOneWriter(const Topic& topic);

/// The processes of a run, as one of them knows them. Decides whether a participant belongs to one of them, and whether
/// it is believed on a topic. Each process has a place, which the first participant that fits its key takes for good.
///
/// The orchestrator knows its children by their process ids, and gives the place of an agent that was started by hand
/// to the first participant that has its name. It hands out what it knows with the experiment. Thread-safe; plain data,
/// without DDS entities.
class Peers {
 public:
  using GuidPrefix = ProcessKey::GuidPrefix;
  using Place = std::pair<std::string, ProcessKey>;  ///< name of a process, and the participants that fit it

  /// Notes that there is such a process, and what is known of it. An exact key replaces what was known before, and so
  /// does the key of another process id: a fresh process has taken the place. Another key does not.
  void Know(const std::string& process, const ProcessKey& key);
  /// The same of a process that `start` starts, whose key it returns. What the process does before that is seen only
  /// then. `start` must not call this object.
  void Know(const std::string& process, const std::function<ProcessKey()>& start);
  /// Notes that there is a process that somebody starts by hand. The first participant that has its name takes its
  /// place, if it fits `key`, or that is of nobody; when it leaves, the place is free again.
  void Await(const std::string& process, const ProcessKey& key);
  /// All places, for other processes.
  std::vector<Place> Places() const;
  /// A number that grows whenever a place is taken by a process that was started by hand or by a fresh one, or becomes
  /// free: other processes must then be told.
  std::uint64_t version() const;

  /// Call it when a participant of this name has been discovered. If the participant fits, it takes the place of its
  /// name: that of a process with its process id, or a place that is free. Returns the name of its process; empty: it
  /// is not of the run.
  std::string Claim(const GuidPrefix& participant, const std::string& name);
  /// Call it when a participant has left. If it had taken the place of a process that is started by hand, the place is
  /// free again.
  void Leave(const GuidPrefix& participant);
  /// The process has ended: its place is free, for the first participant of its name, as after Await().
  void Vacate(const std::string& process);
  /// The participant that has taken the place of this process; nothing: none has.
  std::optional<GuidPrefix> ParticipantOf(const std::string& process) const;
  /// Name of the process of this participant; empty: it is not of the run.
  std::string ProcessOf(const GuidPrefix& participant) const;
  /// Names of all processes of the run whose place exactly this participant has. In a run it has one place, or none; in
  /// the replay of an agent, one participant stands for all processes but the agent's.
  std::vector<std::string> ProcessesOf(const GuidPrefix& participant) const;

  /// Name of the process of this participant, if it may write `topic`; else counts a sample that was not taken, and
  /// returns an empty name.
  std::string Believe(const Topic& topic, const GuidPrefix& writer);
  /// As Believe(), without counting.
  std::string WriterOf(const Topic& topic, const GuidPrefix& writer) const;
  /// Counts a sample that was not taken because its process writes `topic` already, by another writer.
  void RefuseSecond(const Topic& topic, const GuidPrefix& writer);
  /// The samples that were not taken, one line for each writer and topic: "not taken: 3 samples of /request from
  /// 01.0f.78.fd..., who may not write it", "not taken: 1 sample of /clock from 01.0f.78.fd..., a second writer of
  /// physics_server". Samples of a process that was not known yet when they came do not count.
  std::vector<std::string> Refusals() const;

 private:
  struct Entry {
    std::string process;
    ProcessKey key;
    /// With network.security, fits all participants that prove by their certificate that they are of the process: its
    /// voice is the first of them alone, but what the others do is its doing, too.
    std::optional<ProcessKey> proof = {};
    std::optional<ProcessKey> free = {};  // its key while it is free, of a process that is started by hand
    /// That has taken the place: of a process that is started by hand the first, whose leaving frees it; else the last.
    std::optional<GuidPrefix> participant = {};
  };
  // All with mutex_ held.
  void Note(const std::string& process, const ProcessKey& key);
  void Add(const std::string& process, const ProcessKey& key, std::optional<ProcessKey> free);
  /// The process of a participant by its certificate alone; empty: none.
  std::string ProvenProcessOf(const GuidPrefix& participant) const;
  /// Index of the entry whose key fits, of the process `name` if several do; nothing: no key fits.
  std::optional<std::size_t> Find(const GuidPrefix& participant, std::string_view name = {}) const;
  /// The same among the processes that may write `topic`.
  std::optional<std::size_t> FindWriter(const Topic& topic, const GuidPrefix& writer) const;
  void Take(Entry& entry, const GuidPrefix& participant);

  mutable std::mutex mutex_;
  std::vector<Entry> entries_;
  std::uint64_t version_ = 0;
  using Counts = std::map<std::pair<Topic, GuidPrefix>, std::uint64_t>;  // of samples, by where they came from
  Counts refused_, seconds_;
};

}  // namespace mascot
