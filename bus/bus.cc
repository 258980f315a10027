#include "bus/bus.h"

#include <algorithm>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <set>
#include <utility>

#include "bus/discoveries.h"
#include "bus/raw_type.h"
#include "bus/wire.h"
#include "experiment/processes.h"

namespace mascot {

using namespace std::chrono_literals;
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::SerializedPayload_t;
using eprosima::fastrtps::types::ReturnCode_t;

/// Without a new participant. Each time that there is one, all are told that we are there.
constexpr auto kQuiet = 100ms;

eprosima::fastrtps::Duration_t DurationOf(std::chrono::milliseconds time) {
  return eprosima::fastrtps::Duration_t(1e-3L * time.count());
}

}  // namespace

// --- Domain -------------------------------------------------------------------------------------------

Domain::Domain(const DomainOptions& options, std::function<void()> wake, Peers* peers,
               dds::DomainParticipantListener* discovery)
    : wake_(std::move(wake)),
      peers_(peers),
      secure_(options.credentials != nullptr),
      redelivery_(options.loopback ? Redelivery::kSeldom : Redelivery::kOften),
      discoveries_(std::make_unique<Discoveries>([this] { Wake(); }, discovery, secure_)) {
  participant_ = Join(options, discoveries_.get());
  publisher_ = PublisherOf(*participant_);
  subscriber_ = SubscriberOf(*participant_);
}

Domain::~Domain() = default;

void Domain::AwaitOthers(int others, bool announces, const std::function<bool(std::chrono::nanoseconds)>& wait) {
  using Clock = std::chrono::steady_clock;
  const auto deadline = Clock::now() + 2s + (secure_ ? others * 200ms : 0ms);
  auto quiet_since = Clock::now();
  for (std::size_t heard = 0; discovered() < others;) {
    const auto now = Clock::now();
    if (now >= deadline) return;
    const std::size_t heard_before = std::exchange(heard, discoveries_->heard());
    if (heard != heard_before) quiet_since = now;
    if (now - quiet_since >= kQuiet) {
      if (secure_ && announces) Announce();
      quiet_since = now;
    }
    if (!wait(std::min(deadline, quiet_since + kQuiet) - now)) return;
  }
}

void Domain::Announce() {
  dds::DomainParticipantQos qos;
  participant_->get_qos(qos);
  qos.user_data().setValue({static_cast<eprosima::fastrtps::rtps::octet>(++announcements_)});  // else it says nothing
  participant_->set_qos(qos);
}

void Domain::AwaitReaders(std::chrono::milliseconds timeout) {
  publisher_->wait_for_acknowledgments(DurationOf(timeout));
}

int Domain::discovered() const { return discoveries_->participants(); }

void Domain::Fail(std::exception_ptr failure) {
  {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
  }
  wake_();
}

void Domain::RethrowFailure() const {
  const std::lock_guard lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

Handle<dds::Topic> Domain::MakeTopic(const Topic& topic, dds::TypeSupport type) {
  auto* participant = participant_.get();
  const std::string name = topic.DdsName();
  if (participant->find_type(type.get_type_name()).empty()) type.register_type(participant);
  // A participant has one topic object per name: a process that both reads and writes a topic finds the first one here.
  auto* existing = participant->lookup_topicdescription(name);
  if (existing != nullptr) return Handle<dds::Topic>(static_cast<dds::Topic*>(existing), [](dds::Topic*) {});
  return Own<dds::Topic>(participant->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT), "topic " + name,
                         [participant](auto* made) { participant->delete_topic(made); });
}

// --- which endpoints are matched ---------------------------------------------------------------------

namespace {

using Guid = eprosima::fastrtps::rtps::GUID_t;

/// The endpoints that one of ours is matched with.
class Matches {
 public:
  template <class Status>
  void OnChange(const Status& status, const eprosima::fastrtps::rtps::InstanceHandle_t& endpoint) {
    const Guid guid = eprosima::fastrtps::rtps::iHandle2GUID(endpoint);
    const std::lock_guard lock(mutex_);
    number_ = status.current_count;
    if (status.current_count_change > 0) endpoints_.insert(guid);
    if (status.current_count_change < 0) endpoints_.erase(guid);
  }
  /// All of them.
  int Number() const {
    const std::lock_guard lock(mutex_);
    return number_;
  }
  /// Whether the participant of some endpoint is as wanted.
  template <class IsWanted>
  bool Any(const IsWanted& is_wanted) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(endpoints_, [&](const Guid& guid) { return is_wanted(guid.guidPrefix); });
  }
  /// Number of processes, where `processes_of` names the processes of an endpoint's participant; none if it does not
  /// count.
  template <class ProcessesOf>
  int Processes(const ProcessesOf& processes_of) const {
    const std::lock_guard lock(mutex_);
    std::set<std::string> processes;
    for (const Guid& guid : endpoints_)
      for (std::string& process : processes_of(guid.guidPrefix)) processes.insert(std::move(process));
    // If two endpoints come at the same moment, Fast DDS may name one of them twice and the other not at all.
    return static_cast<int>(std::ssize(processes) + std::max<std::ptrdiff_t>(number_ - std::ssize(endpoints_), 0));
  }

 private:
  mutable std::mutex mutex_;
  std::ptrdiff_t number_ = 0;
  std::set<Guid> endpoints_;
};

}  // namespace

Redelivery RedeliveryOfBundles(const Domain& domain, const Experiment& experiment) {
  return AsksAgain(experiment) ? Redelivery::kOnDemand : domain.redelivery();
}

// --- writers ------------------------------------------------------------------------------------------

class WriterBase::Listener : public dds::DataWriterListener {
 public:
  explicit Listener(Domain& domain) : domain_(domain) {}

  void on_publication_matched(dds::DataWriter*, const dds::PublicationMatchedStatus& status) override {
    matches_.OnChange(status, status.last_subscription_handle);
    domain_.Wake();
  }

  int matched() const {
    const Peers* peers = domain_.peers_;
    if (peers == nullptr) return matches_.Number();
    return matches_.Processes([peers](const Peers::GuidPrefix& reader) { return peers->ProcessesOf(reader); });
  }
  bool HasReaderOf(const std::string& process) const {
    return matches_.Any([&](const Peers::GuidPrefix& reader) { return domain_.peers_->ProcessOf(reader) == process; });
  }

 private:
  Domain& domain_;
  Matches matches_;
};

WriterBase::WriterBase(Domain& domain, const Topic& topic, dds::TypeSupport type, Redelivery redelivery)
    : name_(topic.Name()), listener_(std::make_unique<Listener>(domain)), topic_(domain.MakeTopic(topic, type)) {
  auto* publisher = domain.publisher_.get();
  writer_ = Own<dds::DataWriter>(publisher->create_datawriter(topic_.get(), WriterQos(topic.kind, redelivery),
                                                              listener_.get(), dds::StatusMask::publication_matched()),
                                 "writer for " + name_, [publisher](auto* writer) {
                                   writer->set_listener(nullptr);
                                   publisher->delete_datawriter(writer);
                                 });
}

WriterBase::~WriterBase() = default;

int WriterBase::matched() const { return listener_->matched(); }

bool WriterBase::HasReaderOf(const std::string& process) const { return listener_->HasReaderOf(process); }

bool WriterBase::AwaitReaders(std::chrono::milliseconds timeout) {
  return writer_->wait_for_acknowledgments(DurationOf(timeout)) == ReturnCode_t::RETCODE_OK;
}

void WriterBase::WriteAny(void* sample) {
  if (!writer_->write(sample)) throw BusError("Fast DDS did not take a sample of " + name_);
}

// --- readers ------------------------------------------------------------------------------------------

namespace {

/// Where this reader reads shared memory; nullopt: nowhere.
std::optional<eprosima::fastdds::rtps::Locator> SharedMemoryOf(const dds::DataReader& reader) {
  eprosima::fastdds::rtps::LocatorList all;
  if (reader.get_listening_locators(all) != ReturnCode_t::RETCODE_OK) return std::nullopt;
  for (const auto& locator : all)
    if (locator.kind == LOCATOR_KIND_SHM) return locator;
  return std::nullopt;
}

}  // namespace

class ReaderBase::Listener : public dds::DataReaderListener {
 public:
  Listener(Domain& domain, const Topic& topic, OnBytes on_bytes)
      : domain_(domain), topic_(topic), on_bytes_(std::move(on_bytes)) {}

  void on_subscription_matched(dds::DataReader*, const dds::SubscriptionMatchedStatus& status) override {
    matches_.OnChange(status, status.last_publication_handle);
    domain_.Wake();
  }

  void on_data_available(dds::DataReader* reader) override try {
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes_, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data && IsBelieved(info.sample_identity.writer_guid()))
        on_bytes_(bytes_, {.process = process_,
                           .sequence = static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long())});
  } catch (...) {
    domain_.Fail(std::current_exception());
  }

  int matched() const {
    const Peers* peers = domain_.peers_;
    if (peers == nullptr) return matches_.Number();
    return matches_.Processes([&](const Peers::GuidPrefix& writer) {
      std::string process = peers->WriterOf(topic_, writer);
      return process.empty() ? std::vector<std::string>() : std::vector{std::move(process)};
    });
  }

 private:
  /// Whether to take samples of this writer. Notes it, and its process.
  bool IsBelieved(const Guid& writer) {
    if (domain_.peers_ == nullptr || writer == writer_) return true;
    std::string process = domain_.peers_->Believe(topic_, writer.guidPrefix);
    if (process.empty()) return false;
    const bool is_there = !process_.empty() && !domain_.peers_->WriterOf(topic_, writer_.guidPrefix).empty();
    if (HasOneWriter(topic_) && is_there) {
      domain_.peers_->RefuseSecond(topic_, writer.guidPrefix);
      return false;
    }
    writer_ = writer;
    process_ = std::move(process);
    return true;
  }

  Domain& domain_;
  const Topic topic_;
  const OnBytes on_bytes_;
  Matches matches_;
  Bytes bytes_;          // of the sample just taken
  Guid writer_;          // of the last sample that was believed
  std::string process_;  // whose writer that is
};

ReaderBase::ReaderBase(Domain& domain, const Topic& topic, dds::TypeSupport type, dds::DataReaderQos qos,
                       OnBytes on_bytes)
    : listener_(std::make_unique<Listener>(domain, topic, std::move(on_bytes))), topic_(domain.MakeTopic(topic, type)) {
  auto* subscriber = domain.subscriber_.get();
  // With best effort, Fast DDS sends to all addresses of a reader: also by UDP to one that it reaches by shared memory.
  if (qos.reliability().kind == dds::BEST_EFFORT_RELIABILITY_QOS && domain.shared_memory_)
    qos.endpoint().unicast_locator_list.push_back(*domain.shared_memory_);
  const dds::StatusMask mask = dds::StatusMask::subscription_matched() << dds::StatusMask::data_available();
  reader_ = Own<dds::DataReader>(subscriber->create_datareader(topic_.get(), qos, listener_.get(), mask),
                                 "reader for " + topic.Name(), [subscriber](auto* reader) {
                                   reader->set_listener(nullptr);
                                   subscriber->delete_datareader(reader);
                                 });
  if (!domain.shared_memory_) domain.shared_memory_ = SharedMemoryOf(*reader_);
}

ReaderBase::~ReaderBase() = default;

int ReaderBase::matched() const { return listener_->matched(); }

void ThrowNoSample(const Topic& topic, std::size_t bytes, const std::string& type) {
  throw std::runtime_error(topic.Name() + ": a sample of " + std::to_string(bytes) + " bytes is no " + type);
}

// --- raw bytes ----------------------------------------------------------------------------------------

RawReader::RawReader(Domain& domain, const Topic& topic, OnBytes on_sample, Redelivery redelivery)
    : ReaderBase(domain, topic, dds::TypeSupport(new RawType(WireTypeName(topic.kind))), RecorderQos(topic, redelivery),
                 std::move(on_sample)) {}

RawWriter::RawWriter(Domain& domain, const Topic& topic, Redelivery redelivery)
    : WriterBase(domain, topic, dds::TypeSupport(new RawType(WireTypeName(topic.kind))), redelivery) {}

}  // namespace mascot
