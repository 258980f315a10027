#include "bus/outside_domain.h"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <mutex>
#include <set>
#include <utility>

#include "bus/raw_type.h"

namespace mascot {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr int kDepth = 8;

template <class Qos>
void SetCommon(Qos& qos, dds::ReliabilityQosPolicyKind reliability) {
  qos.reliability().kind = reliability;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = kDepth;
  qos.data_sharing().off();  // it would leave files behind
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

DomainOptions OptionsOf(const OutsideDomain::Options& options) {
  DomainOptions of_participant;
  of_participant.domain = options.domain;
  of_participant.transport = "udp";  // strangers may have another kind of shared memory
  of_participant.name = options.name;
  of_participant.loopback = options.address == "127.0.0.1";
  if (!of_participant.loopback) of_participant.address = options.address;
  return of_participant;
}

}  // namespace

class OutsideDomain::Listener final : public dds::DataReaderListener {
 public:
  explicit Listener(std::function<void(const Bytes&)> on_sample) : on_sample_(std::move(on_sample)) {}
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes_, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) on_sample_(bytes_);
  }

 private:
  const std::function<void(const Bytes&)> on_sample_;
  Bytes bytes_;
};

/// Listens to the requests of a service, and to who has found its replies.
class OutsideDomain::Server final : public dds::DataReaderListener, public dds::DataWriterListener {
 public:
  explicit Server(std::function<Bytes(const Bytes&)> answer) : answer_(std::move(answer)) {}
  void on_publication_matched(dds::DataWriter* /*writer*/, const dds::PublicationMatchedStatus& status) override {
    const auto client = eprosima::fastrtps::rtps::iHandle2GUID(status.last_subscription_handle).guidPrefix;
    const std::lock_guard lock(mutex_);
    if (status.current_count_change > 0)
      clients_.insert(client);
    else if (const auto known = clients_.find(client); known != clients_.end())
      clients_.erase(known);
    changed_.notify_all();
  }
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes_, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      Bytes reply = answer_(bytes_);
      if (reply.empty()) continue;
      AwaitReader(info.sample_identity.writer_guid().guidPrefix);
      eprosima::fastrtps::rtps::WriteParams parameters;
      parameters.related_sample_identity() = info.sample_identity;
      replies_->write(&reply, parameters);
    }
  }
  /// Before the first request.
  void ReplyBy(dds::DataWriter& replies) { replies_ = &replies; }

 private:
  /// A client may ask as soon as it has found our reader, before our writer has found its reader. Its reader keeps
  /// nothing that was sent before.
  void AwaitReader(const eprosima::fastrtps::rtps::GuidPrefix_t& client) {
    constexpr auto kPatience = std::chrono::milliseconds(100);
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kPatience, [&] { return clients_.contains(client); });
  }

  dds::DataWriter* replies_ = nullptr;
  const std::function<Bytes(const Bytes&)> answer_;
  Bytes bytes_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::multiset<eprosima::fastrtps::rtps::GuidPrefix_t>
      clients_;  // participants of the readers of replies; guarded by mutex_
};

OutsideDomain::OutsideDomain(const Options& options)
    : participant_(Join(OptionsOf(options), nullptr)),
      publisher_(PublisherOf(*participant_)),
      subscriber_(SubscriberOf(*participant_)) {}

OutsideDomain::~OutsideDomain() = default;

dds::Topic* OutsideDomain::TopicOf(const std::string& topic, const std::string& type) {
  if (const auto known = topics_.find(topic); known != topics_.end()) return known->second.get();
  dds::TypeSupport(new RawType(type)).register_type(participant_.get());
  auto* const participant = participant_.get();
  auto made = Own<dds::Topic>(participant->create_topic(topic, type, dds::TOPIC_QOS_DEFAULT), "topic " + topic,
                              [participant](auto* each) { participant->delete_topic(each); });
  return topics_.emplace(topic, std::move(made)).first->second.get();
}

void OutsideDomain::Read(const std::string& topic, const std::string& type,
                         std::function<void(const Bytes&)> on_sample) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  SetCommon(qos, dds::BEST_EFFORT_RELIABILITY_QOS);
  AddReader(topic, type, qos, *listeners_.emplace_back(std::make_unique<Listener>(std::move(on_sample))));
}

void OutsideDomain::ReadFromLast(const std::string& topic, const std::string& type,
                                 std::function<void(const Bytes&)> on_sample) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  SetCommon(qos, dds::RELIABLE_RELIABILITY_QOS);
  qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  AddReader(topic, type, qos, *listeners_.emplace_back(std::make_unique<Listener>(std::move(on_sample))));
}

void OutsideDomain::AddReader(const std::string& topic, const std::string& type, const dds::DataReaderQos& qos,
                              dds::DataReaderListener& listener) {
  auto* const subscriber = subscriber_.get();
  readers_.push_back(Own<dds::DataReader>(subscriber->create_datareader(TopicOf(topic, type), qos, &listener),
                                          "reader of " + topic, [subscriber](auto* reader) {
                                            reader->set_listener(nullptr);
                                            subscriber->delete_datareader(reader);
                                          }));
}

void OutsideDomain::Announce(const std::string& topic, const std::string& type, Reliability reliability) {
  AddWriter(topic, type, reliability, nullptr);
}

dds::DataWriter& OutsideDomain::AddWriter(const std::string& topic, const std::string& type, Reliability reliability,
                                          dds::DataWriterListener* listener) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  SetCommon(qos,
            reliability == Reliability::kReliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS);
  auto* const publisher = publisher_.get();
  auto writer = Own<dds::DataWriter>(publisher->create_datawriter(TopicOf(topic, type), qos, listener),
                                     "writer of " + topic, [publisher](auto* each) {
                                       each->set_listener(nullptr);
                                       publisher->delete_datawriter(each);
                                     });
  return *writers_.emplace(topic, std::move(writer)).first->second;
}

void OutsideDomain::Serve(const std::string& service, const std::string& type,
                          std::function<Bytes(const Bytes&)> answer) {
  Server& server = *servers_.emplace_back(std::make_unique<Server>(std::move(answer)));
  server.ReplyBy(AddWriter("rr/" + service + "Reply", fmt::format(fmt::runtime(type), "Response"),
                           Reliability::kReliable, &server));
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  SetCommon(qos, dds::RELIABLE_RELIABILITY_QOS);
  AddReader("rq/" + service + "Request", fmt::format(fmt::runtime(type), "Request"), qos, server);
}

void OutsideDomain::Write(const std::string& topic, Bytes sample) {
  if (!writers_.at(topic)->write(&sample)) throw BusError(topic + ": Fast DDS refused to send a sample");
}

int OutsideDomain::ReadersOf(const std::string& topic) const {
  dds::PublicationMatchedStatus status;
  writers_.at(topic)->get_publication_matched_status(status);
  return status.current_count;
}

}  // namespace mascot
