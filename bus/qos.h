#pragma once

#include <cstdint>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bus/security.h"
#include "idl/topics.h"

namespace mascot {

/// Role of a participant in DDS discovery.
enum class DiscoveryRole {
  kPeer,      ///< finds others by multicast, which is fine up to about 20 participants, or by their numbers
  kClient,    ///< asks the discovery server, learns of the endpoints that match its own
  kObserver,  ///< asks the discovery server, learns of all endpoints (Fast DDS: SUPER_CLIENT)
  kServer,    ///< is the discovery server
};

/// DomainOptions::number of the orchestrator and of the physics server, which others need to find.
inline constexpr int kNumberOfOrchestrator = 117, kNumberOfServer = 118;

/// How a process joins the DDS domain of a run.
struct DomainOptions {
  int domain = 0;
  std::string transport = "auto";  ///< one of TransportNames()
  std::string name;                ///< participant name: "agent_3"
  DiscoveryRole role = DiscoveryRole::kPeer;
  std::string server;        ///< "HOST:PORT" of the discovery server, for all roles but kPeer
  bool loopback = false;     ///< use 127.0.0.1 only; off if agents run on other hosts
  std::string address = {};  ///< IPv4 address of the interface to use, besides 127.0.0.1; empty: all interfaces
  int participants = 2;      ///< about how many processes this one talks to; sizes buffers
  /// Number of this participant among those of its host: it has the ports of this number, if they are free. -1: Fast
  /// DDS tries one number after the other, which takes long where there are many.
  int number = -1;
  /// For kPeer: the numbers of the participants of a host to which this one announces itself; they answer. Empty: it
  /// announces itself by multicast, to all of the domain.
  std::vector<int> peers = {};
  std::string peers_at = "127.0.0.1";  ///< IPv4 address of the host of `peers`
  /// With network.security: what the process takes part with. Null: without security.
  std::shared_ptr<const Credentials> credentials = {};
  /// Others believe that this participant is there until it leaves, however long they hear nothing of it: it may be
  /// stopped in a debugger. Else they believe so for 20 s.
  bool patient = false;
};

/// The UDP port at which the participant with this number is announced to, if it has got its ports.
std::uint16_t DiscoveryPort(int domain, int number);

/// The legal values of DomainOptions::transport.
std::span<const std::string_view> TransportNames();

/// Bytes of /dev/shm that a participant with these options takes. Throws std::invalid_argument for an unknown
/// transport.
std::uint64_t SharedMemoryNeeded(const DomainOptions& options);

/// Throws std::invalid_argument for an unknown transport or an unreadable server address.
eprosima::fastdds::dds::DomainParticipantQos ParticipantQos(const DomainOptions& options);

/// How a sample that was lost comes again.
enum class Redelivery {
  kSeldom,    ///< the writer asks seldom what has arrived: shared memory and the loopback interface lose nothing
  kOften,     ///< the writer asks often: a network may lose datagrams
  kAlways,    ///< the writer asks every 2 ms what has arrived, and waits for its readers before it goes on
  kOnDemand,  ///< the writer does not ask: who lacks an answer asks for it (best effort in DDS)
};
eprosima::fastdds::dds::DataWriterQos WriterQos(TopicKind kind, Redelivery redelivery);
eprosima::fastdds::dds::DataReaderQos ReaderQos(const Topic& topic, Redelivery redelivery);
/// As ReaderQos(), but as deep as the writers' history: for the recorder.
eprosima::fastdds::dds::DataReaderQos RecorderQos(const Topic& topic, Redelivery redelivery);

}  // namespace mascot
