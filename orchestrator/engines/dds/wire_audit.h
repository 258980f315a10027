#pragma once

#include <atomic>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "experiment/experiment.h"
#include "idl/topics.h"

namespace mascot {

/// Compares the readers and writers that DDS discovery reports with the graph. This proves that a run was
/// decentralised: it relies on the endpoints that exist in the domain, not on what our code intends. Thread-safe.
class WireAudit : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// Whether an endpoint or participant was discovered or has left since the last call.
  bool HasNews() { return news_.exchange(false); }
  /// Describes the first violation found: an agent that reads or writes a topic that it must not, or another process
  /// that writes in its place. Empty if there is none.
  std::string Violation(const Experiment& experiment) const;
  /// Whether every reader that the graph asks for, and every writer of the agents, has been discovered.
  bool IsComplete(const Experiment& experiment) const;

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant*,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  using Guid = eprosima::fastrtps::rtps::GUID_t;
  using GuidPrefix = eprosima::fastrtps::rtps::GuidPrefix_t;
  struct Endpoint {
    std::string topic;
    bool reads = false;
  };
  void Note(eprosima::fastdds::dds::DomainParticipant* self, const Guid& guid, Endpoint endpoint, bool removed);
  std::string OwnerOf(const Guid& endpoint) const;
  std::string ViolationOf(const Guid& guid, const Endpoint& endpoint, const Experiment& experiment) const;

  std::atomic<bool> news_ = false;
  mutable std::mutex mutex_;
  std::map<GuidPrefix, std::string> participants_;
  std::map<Guid, Endpoint> endpoints_;
};

}  // namespace mascot
