// A law that breaks the rules: the process of agent 1 opens a second participant, which calls itself rviz, and listens
// to a topic that its agent may not hear.
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "agent/laws/plugin/plugin.h"

namespace {

namespace dds = eprosima::fastdds::dds;

/// Matches the writers of a type, and decodes nothing.
class Anything : public dds::TopicDataType {
 public:
  explicit Anything(const std::string& type) {
    setName(("mascot_msgs::msg::dds_::" + type + "_").c_str());
    m_typeSize = 256;
    m_isGetKeyDefined = false;
  }
  bool serialize(void*, eprosima::fastrtps::rtps::SerializedPayload_t*) override { return false; }
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t*, void*) override { return true; }
  std::function<std::uint32_t()> getSerializedSizeProvider(void*) override {
    return [] { return 256U; };
  }
  void* createData() override { return new char; }
  void deleteData(void* data) override { delete static_cast<char*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

/// Says that somebody writes to us.
class Matched : public dds::DataReaderListener {
  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus&) override {
    std::cerr << "eavesdropper: hears\n";
  }
};

/// The DDS domain of this process: the number after --domain on its command line; -1: it has none.
int OwnDomain() {
  std::ifstream file("/proc/self/cmdline");
  const std::string words((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::string option("--domain\0", 9);
  const auto at = words.find(option);
  return at == words.npos ? -1 : std::stoi(words.substr(at + option.size()));
}

void Listen(int domain, const std::string& name, const std::string& type_name) {
  dds::DomainParticipantQos qos;
  qos.name("rviz");
  auto* participant =
      dds::DomainParticipantFactory::get_instance()->create_participant(static_cast<dds::DomainId_t>(domain), qos);
  if (participant == nullptr) return;
  const dds::TypeSupport type(new Anything(type_name));
  type.register_type(participant);
  auto* topic = participant->create_topic("rt/" + name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  auto* subscriber = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  if (topic == nullptr || subscriber == nullptr) return;
  static Matched matched;
  if (subscriber->create_datareader(topic, dds::DATAREADER_QOS_DEFAULT, &matched) != nullptr)
    std::cerr << "eavesdropper: reads /" + name + "\n";
}

class Eavesdropper final : public mascot::Law {
 public:
  explicit Eavesdropper(const mascot::PluginSetup& setup) {
    const std::string topic = setup.params.String("topic"), type = setup.params.String("type");
    if (const int domain = OwnDomain(); setup.id == 1 && domain >= 0) Listen(domain, topic, type);
  }

  Eigen::Vector3d Want_W(double /*t_s*/, const mascot::Motion& self, std::span<const mascot::Heard>) override {
    return -self.v_WB;
  }
};

}  // namespace

MASCOT_PLUGIN_LAW(Eavesdropper)
