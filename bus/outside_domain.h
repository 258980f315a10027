#pragma once

#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bus/bus.h"

namespace mascot {

/// A DDS domain of others, who are no processes of a run: vehicles, say. Topics and types have the names that these
/// give them; samples are bytes, of any length. Anybody in the domain is believed.
class OutsideDomain {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Options {
    int domain = 0;
    std::string name;          ///< of our participant
    std::string address = {};  ///< IPv4 address of the interface to use; empty: all
  };
  /// Whether a sample that was lost is sent again.
  enum class Reliability { kBestEffort, kReliable };

  /// Throws BusError if Fast DDS refuses.
  explicit OutsideDomain(const Options& options);
  ~OutsideDomain();
  OutsideDomain(const OutsideDomain&) = delete;
  OutsideDomain& operator=(const OutsideDomain&) = delete;

  /// Reads a topic, best effort and volatile, which fits every writer. `on_sample` is called in a thread of Fast DDS,
  /// and must not throw. `topic`: as on the wire, "rt/chatter"; `type`: "std_msgs::msg::dds_::String_".
  void Read(const std::string& topic, const std::string& type, std::function<void(const Bytes&)> on_sample);
  /// The same, reliable and transient local: the first sample is the last one that was written before. Fits only
  /// writers that keep it.
  void ReadFromLast(const std::string& topic, const std::string& type, std::function<void(const Bytes&)> on_sample);
  /// Announces that this topic will be written, once.
  void Announce(const std::string& topic, const std::string& type, Reliability reliability);
  /// Writes a sample on a topic that has been announced. Thread-safe.
  void Write(const std::string& topic, Bytes sample);
  /// Answers a service of ROS 2, "cf1/takeoff", as servers with rmw_fastrtps do. `type`: of both messages, with {} for
  /// "Request" and "Response": "std_srvs::srv::dds_::Empty_{}_". `answer` is called with each request in a thread of
  /// Fast DDS, and must not throw; if it returns nothing, there is no answer.
  void Serve(const std::string& service, const std::string& type, std::function<Bytes(const Bytes&)> answer);
  /// How many readers have matched a topic that has been announced.
  int ReadersOf(const std::string& topic) const;

 private:
  class Listener;
  class Server;
  eprosima::fastdds::dds::Topic* TopicOf(const std::string& topic, const std::string& type);
  eprosima::fastdds::dds::DataWriter& AddWriter(const std::string& topic, const std::string& type,
                                                Reliability reliability,
                                                eprosima::fastdds::dds::DataWriterListener* listener);
  void AddReader(const std::string& topic, const std::string& type, const eprosima::fastdds::dds::DataReaderQos& qos,
                 eprosima::fastdds::dds::DataReaderListener& listener);

  Handle<eprosima::fastdds::dds::DomainParticipant> participant_;  // parents first: destroyed in reverse order
  std::map<std::string, Handle<eprosima::fastdds::dds::Topic>> topics_;
  Handle<eprosima::fastdds::dds::Publisher> publisher_;
  Handle<eprosima::fastdds::dds::Subscriber> subscriber_;
  std::vector<std::unique_ptr<Listener>> listeners_;
  std::vector<std::unique_ptr<Server>> servers_;
  std::map<std::string, Handle<eprosima::fastdds::dds::DataWriter>> writers_;
  std::vector<Handle<eprosima::fastdds::dds::DataReader>> readers_;
};

}  // namespace mascot
