#pragma once

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "bus/qos.h"

namespace mascot {

/// Fast DDS refused to create an entity or to send a sample.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Owns one Fast DDS entity and deletes it through the parent that created it.
template <class Entity>
using Handle = std::unique_ptr<Entity, std::function<void(Entity*)>>;

/// Takes ownership of an entity that Fast DDS created. Throws BusError if it is null.
template <class Entity>
Handle<Entity> Own(Entity* entity, const std::string& what, std::function<void(Entity*)> give_back) {
  if (entity == nullptr) throw BusError("Fast DDS refused to make the " + what);
  return Handle<Entity>(entity, std::move(give_back));
}

/// Joins a domain; `discovery`, if given, must outlive the participant. Throws BusError if Fast DDS refuses, and in
/// words if it fails on the way.
Handle<eprosima::fastdds::dds::DomainParticipant> Join(const DomainOptions& options,
                                                       eprosima::fastdds::dds::DomainParticipantListener* discovery);
/// What makes writers and readers of a participant, which must outlive them.
Handle<eprosima::fastdds::dds::Publisher> PublisherOf(eprosima::fastdds::dds::DomainParticipant& participant);
Handle<eprosima::fastdds::dds::Subscriber> SubscriberOf(eprosima::fastdds::dds::DomainParticipant& participant);

}  // namespace mascot
