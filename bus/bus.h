#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <fastdds/dds/domain/DomainParticipant.hpp>
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
#include <string>
#include <vector>

#include "bus/cdr.h"
#include "bus/participant.h"
#include "bus/peers.h"
#include "bus/qos.h"
#include "experiment/experiment.h"
#include "idl/topics.h"

namespace mascot {

class Discoveries;

/// A process's participant, publisher and subscriber in the DDS domain of a run. Must outlive every reader and writer
/// made in it. With credentials, only participants that have authenticated themselves count as discovered.
class Domain {
 public:
  /// `wake` is called, from any thread, when a waiting loop should check again: a participant was discovered, a reader
  /// or writer was matched or unmatched, a callback failed, or Wake() was called. `peers` are the processes of the run:
  /// readers take samples only from these, and only these count as matched. Without `peers`, all participants are
  /// believed, which is right for a process that only listens. `discovery`, if given, is told of every discovered
  /// participant and endpoint. Both must outlive this object. Throws BusError, and what ParticipantQos() throws.
  Domain(const DomainOptions& options, std::function<void()> wake, Peers* peers = nullptr,
         eprosima::fastdds::dds::DomainParticipantListener* discovery = nullptr);
  ~Domain();
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

  /// Number of other participants that have been discovered and have not gone.
  int discovered() const;
  /// Waits, before readers and writers are made, until so many others are discovered, at most 2 s, and with credentials
  /// 0.2 s more for each, because they authenticate each other one by one. Endpoints are told at once to participants
  /// that are known; those that come later ask for them, and Fast DDS answers each after 0.1 s, and tells all others of
  /// it. `wait` waits for the time that it is given, or until the domain wakes it; false from it ends all waiting.
  /// `announces`: others look for this participant, and may have missed its answer (Announce()).
  void AwaitOthers(int others, bool announces, const std::function<bool(std::chrono::nanoseconds)>& wait);
  /// Rethrows the first exception given to Fail(), if any.
  void RethrowFailure() const;
  void Wake() const { wake_(); }
  /// Waits until the readers of all writers of this process have what was written, at most so long. What has not
  /// arrived when this process leaves the domain is lost, also what already lies in a reader's queue.
  void AwaitReaders(std::chrono::milliseconds timeout);
  /// How samples come again that are lost between this process and the others.
  Redelivery redelivery() const { return redelivery_; }
  /// The name that DDS has given this participant.
  const Peers::GuidPrefix& guid_prefix() const { return participant_->guid().guidPrefix; }
  /// Stores a callback's exception, if it is the first, and wakes the loop. Thread-safe.
  void Fail(std::exception_ptr failure);

 private:
  friend class WriterBase;
  friend class ReaderBase;
  /// Tells all participants that are known, and those of DomainOptions::peers, that this one is there. Fast DDS does
  /// so, too: often in the first second, then every 3 s, and in answer to a participant that it hears of. But it
  /// announces a participant first, and lets it receive then, so that a quick answer is lost
  /// (RTPSParticipantImpl::enable).
  void Announce();
  Handle<eprosima::fastdds::dds::Topic> MakeTopic(const Topic& topic, eprosima::fastdds::dds::TypeSupport type);

  std::function<void()> wake_;
  Peers* peers_;
  const bool secure_;
  std::uint8_t announcements_ = 0;  // by Announce()
  Redelivery redelivery_;
  std::optional<eprosima::fastdds::rtps::Locator> shared_memory_;  // where readers read it; known once there is one
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
  std::unique_ptr<Discoveries> discoveries_;
  Handle<eprosima::fastdds::dds::DomainParticipant> participant_;  // parents first: destroyed in reverse order
  Handle<eprosima::fastdds::dds::Publisher> publisher_;
  Handle<eprosima::fastdds::dds::Subscriber> subscriber_;
};

/// How bundles and answers come again that are lost. Both ends must take the same.
Redelivery RedeliveryOfBundles(const Domain& domain, const Experiment& experiment);

/// The part of Writer<PubSub> that does not depend on the type of the sample.
class WriterBase {
 public:
  /// Number of the run's processes that have a matched reader now; without Peers, the number of those readers.
  int matched() const;
  /// Whether this process of the run has a matched reader now. For domains with Peers.
  bool HasReaderOf(const std::string& process) const;
  /// Waits until all matched readers have acknowledged every sample, at most `timeout`. Returns whether they have. Call
  /// it before the process ends: its shared memory goes with it, and samples that are not read by then are lost.
  bool AwaitReaders(std::chrono::milliseconds timeout);

 protected:
  WriterBase(Domain& domain, const Topic& topic, eprosima::fastdds::dds::TypeSupport type, Redelivery redelivery);
  ~WriterBase();
  void WriteAny(void* sample);

 private:
  class Listener;
  std::string name_;
  std::unique_ptr<Listener> listener_;
  Handle<eprosima::fastdds::dds::Topic> topic_;
  Handle<eprosima::fastdds::dds::DataWriter> writer_;
};

/// The sender of a sample.
struct Sender {
  const std::string& process;  ///< name of a process of the run; empty without Peers
  std::int64_t sequence = 0;   ///< the writer's sequence number, from 1
};

/// The part of Reader<PubSub> and RawReader that does not depend on the type of the sample.
class ReaderBase {
 public:
  using Bytes = std::vector<std::uint8_t>;
  virtual ~ReaderBase();
  /// Number of the run's processes with a matched writer that is believed; without Peers, the number of writers.
  int matched() const;

 protected:
  using OnBytes = std::function<void(const Bytes&, const Sender&)>;
  /// The reception thread calls `on_bytes` for every sample of a writer that is believed (Peers), one at a time. On a
  /// topic that only one process may write, only the first writer of that process is believed. `type` must hand out
  /// samples as Bytes.
  ReaderBase(Domain& domain, const Topic& topic, eprosima::fastdds::dds::TypeSupport type,
             eprosima::fastdds::dds::DataReaderQos qos, OnBytes on_bytes);

 private:
  class Listener;
  std::unique_ptr<Listener> listener_;
  Handle<eprosima::fastdds::dds::Topic> topic_;
  Handle<eprosima::fastdds::dds::DataReader> reader_;
};

/// Throws std::runtime_error: the rightful writer of `topic` has sent `bytes` bytes that are not a sample of `type`.
[[noreturn]] void ThrowNoSample(const Topic& topic, std::size_t bytes, const std::string& type);

/// Publishes samples of a fastddsgen type (PubSub is, e.g., AgentStatePubSubType). Thread-safe.
template <class PubSub>
class Writer : public WriterBase {
 public:
  Writer(Domain& domain, const Topic& topic)
      : WriterBase(domain, topic, eprosima::fastdds::dds::TypeSupport(new WireType<PubSub>), domain.redelivery()) {}
  /// Throws BusError if Fast DDS does not accept the sample.
  void Write(typename PubSub::type& sample) { WriteAny(&sample); }
};

/// Calls `on_sample` for every sample, in Fast DDS's reception thread: a hop to another thread would cost half a round
/// trip. An exception that `on_sample` throws goes to Domain::Fail(), and so does one for bytes that are not a sample.
template <class PubSub>
class Reader : public ReaderBase {
 public:
  using Sample = typename PubSub::type;
  using Callback = std::function<void(const Sample&)>;
  using CallbackWithSender = std::function<void(const Sample&, const Sender&)>;

  Reader(Domain& domain, const Topic& topic, Callback on_sample)
      : Reader(domain, topic,
               [on_sample = std::move(on_sample)](const Sample& sample, const Sender&) { on_sample(sample); }) {}
  Reader(Domain& domain, const Topic& topic, CallbackWithSender on_sample)
      : ReaderBase(domain, topic, eprosima::fastdds::dds::TypeSupport(new WireType<PubSub>),
                   ReaderQos(topic, domain.redelivery()),
                   [topic, sample = std::make_shared<Sample>(), on_sample = std::move(on_sample)](
                       const Bytes& bytes, const Sender& sender) {
                     if (!Decode<PubSub>(bytes, *sample)) ThrowNoSample(topic, bytes.size(), PubSub().getName());
                     on_sample(*sample, sender);
                   }) {}
};

/// Calls `on_sample` with the bytes of every sample as they were on the wire, with the 4-byte encapsulation header. For
/// the recorder.
class RawReader : public ReaderBase {
 public:
  RawReader(Domain& domain, const Topic& topic, OnBytes on_sample)
      : RawReader(domain, topic, std::move(on_sample), domain.redelivery()) {}
  /// `redelivery`: that of the writers.
  RawReader(Domain& domain, const Topic& topic, OnBytes on_sample, Redelivery redelivery);
};

/// Publishes samples that are bytes already: the 4-byte encapsulation header, then CDR. Thread-safe.
class RawWriter : public WriterBase {
 public:
  using Bytes = ReaderBase::Bytes;
  RawWriter(Domain& domain, const Topic& topic) : RawWriter(domain, topic, domain.redelivery()) {}
  RawWriter(Domain& domain, const Topic& topic, Redelivery redelivery);
  /// Throws BusError if Fast DDS does not accept the sample.
  void Write(Bytes& sample) { WriteAny(&sample); }
};

}  // namespace mascot
