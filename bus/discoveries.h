#pragma once

#include <atomic>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include "bus/process_key.h"

namespace mascot {

/// Counts the participants that are in the domain, and passes on what discovery tells of them. With security, what
/// discovery tells of a participant counts once the participant has authenticated itself; others are nobody.
class Discoveries : public eprosima::fastdds::dds::DomainParticipantListener {
 public:
  /// `on_change` is called, from any thread, when a participant has come or gone. `next`: is told of every participant
  /// and endpoint; null: nobody is. `secure`: only of those that have authenticated themselves.
  Discoveries(std::function<void()> on_change, eprosima::fastdds::dds::DomainParticipantListener* next, bool secure);
  ~Discoveries() override;
  Discoveries(const Discoveries&) = delete;
  Discoveries& operator=(const Discoveries&) = delete;

  int participants() const { return participants_; }
  /// With security, also those that have not authenticated themselves.
  std::size_t heard() const;

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void onParticipantAuthentication(eprosima::fastdds::dds::DomainParticipant* participant,
                                   eprosima::fastrtps::rtps::ParticipantAuthenticationInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  using GuidPrefix = ProcessKey::GuidPrefix;
  /// What is known of a participant, with security.
  struct Known {
    std::unique_ptr<eprosima::fastrtps::rtps::ParticipantProxyData> data = {};  // null: not told yet
    bool is_authenticated = false;
    bool is_passed_on = false;
  };
  void PassOn(eprosima::fastdds::dds::DomainParticipant* participant,
              eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info);
  void PassOnIfComplete(eprosima::fastdds::dds::DomainParticipant* participant, Known& known);
  bool MayPassOn(const GuidPrefix& participant) const;

  const std::function<void()> on_change_;
  eprosima::fastdds::dds::DomainParticipantListener* const next_;
  const bool secure_;
  std::atomic<int> participants_ = 0;
  mutable std::recursive_mutex mutex_;  // what is next may make Fast DDS tell more in the same thread
  std::map<GuidPrefix, Known> known_;
};

}  // namespace mascot
