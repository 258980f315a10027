#pragma once

#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/qos.h"
#include "idl/topics.h"

namespace mascot {

/// The middleware refused something that a run cannot do without.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Owns one Fast DDS entity and hands it back to the parent that made it.
template <class Entity>
using Handle = std::unique_ptr<Entity, std::function<void(Entity*)>>;

/// One process's place in a run's DDS domain. Outlives every reader and writer made in it.
class Domain {
 public:
  /// `wake` is called, from any thread, whenever a loop that waits should look again: somebody was matched
  /// or lost, or a callback failed. `discovery`, if given, hears of every endpoint and outlives this.
  Domain(const DomainOptions& options, std::function<void()> wake,
         eprosima::fastdds::dds::DomainParticipantListener* discovery = nullptr);

  /// Rethrows the first exception that left a callback, if any.
  void RethrowFailure() const;
  void Wake() const { wake_(); }
  /// Notes an exception of a callback and wakes the loop.
  void Fail(std::exception_ptr failure);

 private:
  friend class WriterBase;
  friend class ReaderBase;
  Handle<eprosima::fastdds::dds::Topic> MakeTopic(const Topic& topic, eprosima::fastdds::dds::TypeSupport type);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
  Handle<eprosima::fastdds::dds::DomainParticipant> participant_;  // parents first: members die in reverse
  Handle<eprosima::fastdds::dds::Publisher> publisher_;
  Handle<eprosima::fastdds::dds::Subscriber> subscriber_;
};

/// What Writer<T> does that does not depend on T.
class WriterBase {
 public:
  /// Readers matched now.
  int matched() const;
  /// Waits until every reader has everything that was written, at most `timeout`. Shared memory goes with the process
  /// that wrote it, and what nobody has read by then is lost.
  void AwaitReaders(std::chrono::milliseconds timeout);

 protected:
  WriterBase(Domain& domain, const Topic& topic, eprosima::fastdds::dds::TypeSupport type);
  ~WriterBase();
  void WriteAny(void* sample);

 private:
  class Listener;
  std::string name_;
  std::unique_ptr<Listener> listener_;
  Handle<eprosima::fastdds::dds::Topic> topic_;
  Handle<eprosima::fastdds::dds::DataWriter> writer_;
};

/// What readers do that does not depend on the type of the sample.
class ReaderBase {
 public:
  virtual ~ReaderBase();
  /// Writers matched now.
  int matched() const;

 protected:
  /// `on_sample(sequence)` runs in the reception thread for every sample taken into `sample`, one at a time.
  ReaderBase(Domain& domain, const Topic& topic, eprosima::fastdds::dds::TypeSupport type,
             const eprosima::fastdds::dds::DataReaderQos& qos, void* sample,
             std::function<void(std::int64_t sequence)> on_sample);

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
  Handle<eprosima::fastdds::dds::Topic> topic_;
  Handle<eprosima::fastdds::dds::DataReader> reader_;
};

/// A fastddsgen type whose padding bytes are zero on the wire: Fast CDR leaves old memory in them, which
/// would make recordings differ from run to run.
template <class PubSub>
class ZeroPadded : public PubSub {
 public:
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
};

/// Publishes samples of a fastddsgen type (PubSub is, e.g., AgentStatePubSubType). Thread-safe.
template <class PubSub>
class Writer : public WriterBase {
 public:
  Writer(Domain& domain, const Topic& topic)
      : WriterBase(domain, topic, eprosima::fastdds::dds::TypeSupport(new ZeroPadded<PubSub>)) {}
  /// Throws BusError if the middleware does not take it.
  void Write(typename PubSub::type& sample) { WriteAny(&sample); }
};

/// Hands every sample to `on_sample`, in the reception thread: a hop to another thread would cost half a
/// round trip. The only place where our code runs in a DDS thread: an exception becomes the domain's failure.
template <class PubSub>
class Reader : public ReaderBase {
 public:
  using Sample = typename PubSub::type;
  using Callback = std::function<void(const Sample&)>;
  Reader(Domain& domain, const Topic& topic, Callback on_sample)
      : Reader(domain, topic, std::move(on_sample), std::make_shared<Sample>()) {}

 private:
  Reader(Domain& domain, const Topic& topic, Callback on_sample, std::shared_ptr<Sample> sample)
      : ReaderBase(domain, topic, eprosima::fastdds::dds::TypeSupport(new ZeroPadded<PubSub>), ReaderQos(topic),
                   sample.get(), [sample, on_sample = std::move(on_sample)](std::int64_t) { on_sample(*sample); }) {}
};

/// Hands over the bytes of every sample as they were on the wire (with the 4 bytes of encapsulation), and
/// its writer's sequence number (from 1); for the recorder.
class RawReader : public ReaderBase {
 public:
  using Bytes = std::vector<std::uint8_t>;
  using Callback = std::function<void(const Bytes& cdr, std::int64_t sequence)>;
  RawReader(Domain& domain, const Topic& topic, Callback on_sample);

 private:
  RawReader(Domain& domain, const Topic& topic, Callback on_sample, std::shared_ptr<Bytes> bytes);
};

template <class PubSub>
bool ZeroPadded<PubSub>::serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) {
  std::memset(payload->data, 0, payload->max_size);
  return PubSub::serialize(data, payload);
}

}  // namespace mascot
