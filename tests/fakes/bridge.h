#pragma once

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include <chrono>
#include <csignal>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "tests/fakes/options.h"

namespace mascot::fakes {

namespace dds = eprosima::fastdds::dds;

/// The participant of a fake in the vehicles' domain, by UDP.
class Bridge {
 public:
  Bridge(const OnDds& on_dds, const std::string& name) {
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    qos.name(name);
    qos.transport().use_builtin_transports = false;
    auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    if (!on_dds.any_interface) udp->interfaceWhiteList.push_back("127.0.0.1");
    qos.transport().user_transports.push_back(udp);
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<dds::DomainId_t>(on_dds.domain), qos);
    if (participant_ == nullptr) throw std::runtime_error("Fast DDS refused to make the participant");
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~Bridge() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  /// `type`: its name on the wire, which need not be that of the C++ type.
  template <class PubSub>
  dds::DataWriter* Out(const std::string& topic, const std::string& type, dds::ReliabilityQosPolicyKind reliability,
                       dds::DurabilityQosPolicyKind durability = dds::VOLATILE_DURABILITY_QOS) {
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    qos.reliability().kind = reliability;
    qos.durability().kind = durability;
    qos.data_sharing().off();
    return publisher_->create_datawriter(MakeTopic<PubSub>(topic, type), qos);
  }
  template <class PubSub>
  dds::DataReader* In(const std::string& topic, const std::string& type,
                      dds::ReliabilityQosPolicyKind reliability = dds::BEST_EFFORT_RELIABILITY_QOS) {
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = reliability;
    qos.history().depth = 16;
    qos.data_sharing().off();
    return subscriber_->create_datareader(MakeTopic<PubSub>(topic, type), qos);
  }

 private:
  template <class PubSub>
  dds::Topic* MakeTopic(const std::string& topic, const std::string& type) {
    dds::TypeSupport(new PubSub).register_type(participant_, type);
    return participant_->create_topic(topic, type, dds::TOPIC_QOS_DEFAULT);
  }

  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
};

/// Calls `take(sample, info)` for all that has come.
template <class Sample, class Take>
void TakeAll(dds::DataReader* reader, const Take& take) {
  Sample sample;
  dds::SampleInfo info;
  while (reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
    if (info.valid_data) take(sample, info);
}

/// Answers a request of a service of ROS 2.
template <class Response>
void Reply(dds::DataWriter* writer, Response response, const dds::SampleInfo& request) {
  eprosima::fastrtps::rtps::WriteParams parameters;
  parameters.related_sample_identity() = request.sample_identity;
  writer->write(&response, parameters);
}

/// Calls `step` again and again, each time this long after the last, until SIGINT or SIGTERM.
inline void StepUntilAsked(std::chrono::microseconds period, const std::function<void()>& step) {
  static volatile std::sig_atomic_t ends = 0;
  std::signal(SIGINT, [](int) { ends = 1; });
  std::signal(SIGTERM, [](int) { ends = 1; });
  for (auto next = std::chrono::steady_clock::now(); ends == 0;) {
    step();
    next += period;
    std::this_thread::sleep_until(next);
  }
}

}  // namespace mascot::fakes
