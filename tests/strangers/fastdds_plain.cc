// fastdds_plain PROFILES DOMAIN TOPIC...: reads topics of a run by Fast DDS, with types that fastddsgen has made of the
// plain IDL and with the profiles of a file, and prints every sample, a line of JSON each, until it is killed. It uses
// nothing else of MASCOT.
#include <unistd.h>

#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <iostream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mascotPubSubTypes.h"

namespace {

namespace dds = eprosima::fastdds::dds;
namespace msg = mascot_msgs::msg::dds_;
using Json = nlohmann::json;

Json Numbers(const msg::AgentState_& state) {
  const auto& p = state.pose().position();
  const auto& q = state.pose().orientation();
  const auto& v = state.twist().linear();
  const auto& w = state.twist().angular();
  const auto& a = state.acceleration();
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), v.x(),
          v.y(), v.z(), w.x(), w.y(), w.z(), a.x(), a.y(), a.z()};
}

Json Numbers(const msg::AgentCommand_& command) {
  const auto& u = command.actuator();
  const auto& wanted = command.acceleration_wanted();
  const auto& limited = command.acceleration_limited();
  return {u[0], u[1], u[2], u[3], wanted.x(), wanted.y(), wanted.z(), limited.x(), limited.y(), limited.z()};
}

template <class OfAgent>
Json Seen(const OfAgent& sample) {
  return {{"sec", sample.stamp().sec()},
          {"nanosec", sample.stamp().nanosec()},
          {"tick", sample.tick()},
          {"agent", sample.agent()},
          {"numbers", Numbers(sample)}};
}

Json Seen(const rosgraph_msgs::msg::dds_::Clock_& clock) {
  return {{"sec", clock.clock().sec()}, {"nanosec", clock.clock().nanosec()}};
}

Json Seen(const msg::TickRow_& row) {
  Json states = Json::array(), commands = Json::array();
  for (const auto& state : row.states()) states.push_back(Seen(state));
  for (const auto& command : row.commands()) commands.push_back(Seen(command));
  return {{"tick", row.tick()}, {"states", states}, {"commands", commands}};
}

Json Seen(const msg::Experiment_& experiment) { return {{"name", experiment.name()}, {"toml", experiment.toml()}}; }

std::mutex printing;

/// Prints the samples of one topic.
template <class PubSub>
class Printer : public dds::DataReaderListener {
 public:
  explicit Printer(std::string topic) : topic_(std::move(topic)) {}
  void on_data_available(dds::DataReader* reader) override {
    typename PubSub::type sample;
    dds::SampleInfo info;
    while (reader->take_next_sample(&sample, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      Json seen = Seen(sample);
      seen["topic"] = topic_;
      const std::lock_guard lock(printing);
      std::cout << seen.dump() << std::endl;
    }
  }

 private:
  std::string topic_;
};

template <class PubSub>
std::unique_ptr<dds::DataReaderListener> Read(dds::DomainParticipant& participant, dds::Subscriber& subscriber,
                                              const std::string& name, const std::string& profile) {
  const dds::TypeSupport type(new PubSub);
  type.register_type(&participant);
  dds::Topic* topic = participant.create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  auto printer = std::make_unique<Printer<PubSub>>(name);
  if (topic == nullptr || subscriber.create_datareader_with_profile(topic, profile, printer.get()) == nullptr)
    throw std::runtime_error("cannot read " + name);
  return printer;
}

std::unique_ptr<dds::DataReaderListener> Read(dds::DomainParticipant& participant, dds::Subscriber& subscriber,
                                              const std::string& name) {
  const std::string last = name.substr(name.rfind('/') + 1);
  if (last == "state") return Read<msg::AgentState_PubSubType>(participant, subscriber, name, "mascot_ticks");
  if (last == "command") return Read<msg::AgentCommand_PubSubType>(participant, subscriber, name, "mascot_ticks");
  if (last == "row") return Read<msg::TickRow_PubSubType>(participant, subscriber, name, "mascot_ticks");
  if (last == "experiment") return Read<msg::Experiment_PubSubType>(participant, subscriber, name, "mascot_latest");
  if (last == "clock")
    return Read<rosgraph_msgs::msg::dds_::Clock_PubSubType>(participant, subscriber, name, "mascot_ticks");
  throw std::runtime_error("no type for " + name);
}

void ReadAll(const std::string& profiles, int domain, const std::vector<std::string>& topics) {
  auto& factory = *dds::DomainParticipantFactory::get_instance();
  if (factory.load_XML_profiles_file(profiles) != eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
    throw std::runtime_error("cannot load " + profiles);
  dds::DomainParticipant* participant = factory.create_participant_with_profile(
      static_cast<dds::DomainId_t>(domain), "mascot", nullptr, dds::StatusMask::none());
  if (participant == nullptr) throw std::runtime_error("cannot join domain " + std::to_string(domain));
  dds::Subscriber* subscriber = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  std::vector<std::unique_ptr<dds::DataReaderListener>> printers;
  for (const std::string& topic : topics) printers.push_back(Read(*participant, *subscriber, topic));
  for (;;) pause();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) return 2;
  ReadAll(argv[1], std::atoi(argv[2]), {argv + 3, argv + argc});
} catch (const std::exception& failure) {
  std::cerr << "error: " << failure.what() << std::endl;
  return 1;
}
