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

/// Fast DDS refused to create an entity or to send a sample.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Owns one Fast DDS entity and deletes it through the parent that created it.
template <class Entity>
using Handle = std::unique_ptr<Entity, std::function<void(Entity*)>>;

/// A process's participant, publisher and subscriber in the DDS domain of a run. Must outlive every reader and writer
/// made in it.
class Domain {
 public:
  /// `wake` is called, from any thread, when a waiting loop should check again: a reader or writer was matched or
  /// unmatched, a callback failed, or Wake() was called. `discovery`, if given, is told of every discovered participant
  /// and endpoint; it must outlive this object. Throws BusError, and what ParticipantQos() throws.
  Domain(const DomainOptions& options, std::function<void()> wake,
         eprosima::fastdds::dds::DomainParticipantListener* discovery = nullptr);

  /// Rethrows the first exception given to Fail(), if any.
  void RethrowFailure() const;
  void Wake() const { wake_(); }
  /// Stores a callback's exception, if it is the first, and wakes the loop. Thread-safe.
  void Fail(std::exception_ptr failure);

 private:
  friend class WriterBase;
  friend class ReaderBase;
  Handle<eprosima::fastdds::dds::Topic> MakeTopic(const Topic& topic, eprosima::fastdds::dds::TypeSupport type);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
  Handle<eprosima::fastdds::dds::DomainParticipant> participant_;  // parents first: destroyed in reverse order
  Handle<eprosima::fastdds::dds::Publisher> publisher_;
  Handle<eprosima::fastdds::dds::Subscriber> subscriber_;
};

/// The part of Writer<PubSub> that does not depend on the type of the sample.
class WriterBase {
 public:
  /// Number of readers matched now.
  int matched() const;
  /// Waits until all matched readers have acknowledged every sample, at most `timeout`. To be called before a process
  /// ends: its shared memory goes with it, and samples that are not read by then are lost.
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

/// The part of Reader<PubSub> and RawReader that does not depend on the type of the sample.
class ReaderBase {
 public:
  virtual ~ReaderBase();
  /// Number of writers matched now.
  int matched() const;

 protected:
  /// For every sample, one at a time, the reception thread takes it into `sample` and calls `on_sample` with the
  /// writer's sequence number.
  ReaderBase(Domain& domain, const Topic& topic, eprosima::fastdds::dds::TypeSupport type,
             const eprosima::fastdds::dds::DataReaderQos& qos, void* sample,
             std::function<void(std::int64_t sequence)> on_sample);

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
  Handle<eprosima::fastdds::dds::Topic> topic_;
  Handle<eprosima::fastdds::dds::DataReader> reader_;
};

/// A fastddsgen type whose padding bytes are zero on the wire. Fast CDR leaves old memory in them, which would make
/// recordings differ from run to run.
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
  /// Throws BusError if Fast DDS does not accept the sample.
  void Write(typename PubSub::type& sample) { WriteAny(&sample); }
};

/// Calls `on_sample` for every sample, in Fast DDS's reception thread: a hop to another thread would cost half a round
/// trip. An exception that `on_sample` throws goes to Domain::Fail().
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

/// Calls `on_sample` with the bytes of every sample as they were on the wire (with the 4-byte encapsulation header) and
/// its writer's sequence number (from 1). For the recorder.
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
