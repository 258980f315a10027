#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>
#include <string>

#include "bus/peers.h"
#include "experiment/experiment.h"
#include "idl/topics.h"

namespace mascot {

/// Compares the readers and writers that DDS discovery reports with the graph. This proves that a run was
/// decentralised: it relies on the endpoints that exist in the domain, not on what our code intends.
///
/// A process hears what all of its participants hear. Other programs may listen, under names that are not those of
/// processes of the run, and may not write what a run reads. A violation that was found stays found, also when the
/// endpoint has gone. Thread-safe.
class WireAudit : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  using Guid = eprosima::fastrtps::rtps::GUID_t;
  using GuidPrefix = Peers::GuidPrefix;

  /// `peers` knows the processes of the run; this audit gives agents that are started by hand their places there.
  WireAudit(const Experiment& experiment, Peers& peers) : experiment_(experiment), peers_(peers) {}

  /// The first violation that was found: which process reads or writes a topic that it must not. Empty: there was none.
  std::string Violation() const;
  /// This process has ended: what it has read and written is not there any more, whatever discovery still believes.
  void OnEnd(const std::string& process);
  /// Whether every reader that the graph requires, and every writer of the agents, has been discovered.
  bool IsComplete() const;

  // What discovery reports.
  /// `whereabouts`: what else is known of the participant, for messages: "process 4711 on vm".
  void OnParticipant(const GuidPrefix& participant, const std::string& name, const std::string& whereabouts);
  void OnParticipantGone(const GuidPrefix& participant);
  void OnEndpoint(const Guid& guid, const std::string& dds_topic, bool reads);
  void OnEndpointGone(const Guid& guid);

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant*,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  struct Participant {
    std::string name;
    std::string whereabouts;
    std::string process;  // of the run; empty: none
  };
  struct Endpoint {
    Topic topic;
    bool reads = false;
    Participant owner;
  };
  /// Notes a violation, if it is the first; empty: there is none.
  void Find(const std::string& violation);
  std::string ViolationOf(const Guid& guid, const Endpoint& endpoint) const;
  /// The violation of an endpoint that writes what it must not.
  std::string WrongWriter(const Endpoint& endpoint) const;
  bool IsProcess(const std::string& name) const;

  const Experiment& experiment_;
  Peers& peers_;
  mutable std::mutex mutex_;
  std::map<GuidPrefix, Participant> participants_;
  std::map<Guid, Endpoint> endpoints_;  // on topics of the run, there now
  std::string violation_;
};

}  // namespace mascot
