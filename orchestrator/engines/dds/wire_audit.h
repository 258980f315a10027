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

/// Learns from DDS discovery who reads and writes what, and holds it against the graph. The proof that a
/// run was decentralised: made from what is on the wire, not from what our code means to do.
class WireAudit : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// Something was discovered or has left since the last call.
  bool HasNews() { return news_.exchange(false); }
  /// What is wrong: an agent that reads or writes what it must not, or somebody else who writes in its
  /// place. Empty if nothing is.
  std::string Violation(const Experiment& experiment) const;
  /// Every reader that the graph asks for is there, and every agent's writers.
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
