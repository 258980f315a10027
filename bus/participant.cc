#include "bus/participant.h"

#include <fastrtps/xmlparser/XMLProfileManager.h>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <optional>

namespace mascot {
namespace {

namespace dds = eprosima::fastdds::dds;

/// Intraprocess delivery would call a reader's callback in the thread that writes, with the writer's locks held.
void DisableIntraprocessDelivery() {
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

/// If Fast DDS cannot start one of its threads, it joins it all the same, which is an "Invalid argument".
dds::DomainParticipant* CreateParticipant(const DomainOptions& options, dds::DomainParticipantListener* discovery) try {
  dds::DomainParticipantQos qos = ParticipantQos(options);
  std::optional<Enclave> enclave;
  if (options.credentials != nullptr) enclave.emplace(*options.credentials).Secure(qos);
  return dds::DomainParticipantFactory::get_instance()->create_participant(static_cast<dds::DomainId_t>(options.domain),
                                                                           qos, discovery, dds::StatusMask::none());
} catch (const std::invalid_argument&) {
  throw;
} catch (const std::exception& failure) {
  throw BusError("Fast DDS failed to join domain " + std::to_string(options.domain) + " (" + failure.what() +
                 "); is there a limit of memory or threads, such as ulimit -v or -u?");
}

}  // namespace

Handle<dds::DomainParticipant> Join(const DomainOptions& options, dds::DomainParticipantListener* discovery) {
  DisableIntraprocessDelivery();
  return Own<dds::DomainParticipant>(CreateParticipant(options, discovery),
                                     "participant in domain " + std::to_string(options.domain), [](auto* participant) {
                                       participant->set_listener(nullptr);
                                       dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
                                     });
}

Handle<dds::Publisher> PublisherOf(dds::DomainParticipant& participant) {
  return Own<dds::Publisher>(participant.create_publisher(dds::PUBLISHER_QOS_DEFAULT), "publisher",
                             [&participant](auto* publisher) { participant.delete_publisher(publisher); });
}

Handle<dds::Subscriber> SubscriberOf(dds::DomainParticipant& participant) {
  return Own<dds::Subscriber>(participant.create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT), "subscriber",
                              [&participant](auto* subscriber) { participant.delete_subscriber(subscriber); });
}

}  // namespace mascot
