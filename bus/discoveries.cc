#include "bus/discoveries.h"

#include <fastdds/rtps/builtin/data/ParticipantProxyData.h>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <utility>

namespace mascot {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using Info = rtps::ParticipantDiscoveryInfo;

namespace {

bool HasGone(const Info& info) {
  return info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT;
}

}  // namespace

Discoveries::Discoveries(std::function<void()> on_change, dds::DomainParticipantListener* next, bool secure)
    : on_change_(std::move(on_change)), next_(next), secure_(secure) {}

Discoveries::~Discoveries() = default;

void Discoveries::PassOn(dds::DomainParticipant* participant, Info&& info) {
  if (info.status == Info::DISCOVERED_PARTICIPANT) ++participants_;
  if (HasGone(info)) --participants_;
  if (next_ != nullptr) next_->on_participant_discovery(participant, std::move(info));
  on_change_();
}

void Discoveries::on_participant_discovery(dds::DomainParticipant* participant, Info&& info) {
  if (!secure_) return PassOn(participant, std::move(info));
  const GuidPrefix prefix = info.info.m_guid.guidPrefix;
  const std::lock_guard lock(mutex_);
  if (HasGone(info)) {
    const auto gone = known_.extract(prefix);
    if (!gone.empty() && gone.mapped().is_passed_on) PassOn(participant, std::move(info));
    return;
  }
  Known& known = known_[prefix];
  if (known.data == nullptr) known.data = std::make_unique<rtps::ParticipantProxyData>(info.info);
  PassOnIfComplete(participant, known);
}

std::size_t Discoveries::heard() const {
  const std::lock_guard lock(mutex_);
  return known_.size();
}

void Discoveries::onParticipantAuthentication(dds::DomainParticipant* participant,
                                              rtps::ParticipantAuthenticationInfo&& info) {
  if (!secure_ || info.status != rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT) return;
  const std::lock_guard lock(mutex_);
  Known& known = known_[info.guid.guidPrefix];
  known.is_authenticated = true;
  PassOnIfComplete(participant, known);
}

void Discoveries::PassOnIfComplete(dds::DomainParticipant* participant, Known& known) {
  if (!known.is_authenticated || known.data == nullptr || std::exchange(known.is_passed_on, true)) return;
  PassOn(participant, Info(*known.data));
}

bool Discoveries::MayPassOn(const GuidPrefix& participant) const {
  if (next_ == nullptr) return false;
  if (!secure_) return true;
  const std::lock_guard lock(mutex_);
  const auto known = known_.find(participant);
  return known != known_.end() && known->second.is_authenticated;
}

void Discoveries::on_subscriber_discovery(dds::DomainParticipant* participant, rtps::ReaderDiscoveryInfo&& info) {
  if (MayPassOn(info.info.guid().guidPrefix)) next_->on_subscriber_discovery(participant, std::move(info));
}

void Discoveries::on_publisher_discovery(dds::DomainParticipant* participant, rtps::WriterDiscoveryInfo&& info) {
  if (MayPassOn(info.info.guid().guidPrefix)) next_->on_publisher_discovery(participant, std::move(info));
}

}  // namespace mascot
