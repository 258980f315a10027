#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <span>
#include <string>
#include <string_view>

#include "idl/topics.h"

namespace mascot {

/// Samples of per-tick topics that writers and the recorder keep; the server publishes tick k only after
/// the recorder has confirmed tick k - kRecorderWindow, so nothing is overwritten before it was recorded.
inline constexpr int kHistoryDepth = 128;
inline constexpr int kRecorderWindow = 64;

/// Part of a process in discovery.
enum class DiscoveryRole {
  kPeer,      ///< everybody finds everybody by multicast; fine up to about 20 participants
  kClient,    ///< asks the discovery server, learns of what it talks to
  kObserver,  ///< asks the discovery server, learns of everybody (Fast DDS: SUPER_CLIENT)
  kServer,    ///< is the discovery server
};

/// Where and how a process joins a run.
struct DomainOptions {
  int domain = 0;
  std::string transport = "auto";  ///< a name of the transports' table
  std::string name;                ///< participant name: "agent_3"
  DiscoveryRole role = DiscoveryRole::kPeer;
  std::string server;     ///< "HOST:PORT" of the discovery server, for all roles but kPeer
  bool loopback = false;  ///< use 127.0.0.1 only; off where agents sit on other hosts
  int participants = 2;   ///< how many join the run, about; sizes buffers
};

std::span<const std::string_view> TransportNames();

/// Throws std::invalid_argument for an unknown transport or an unreadable server address.
eprosima::fastdds::dds::DomainParticipantQos ParticipantQos(const DomainOptions& options);
eprosima::fastdds::dds::DataWriterQos WriterQos(TopicKind kind);
eprosima::fastdds::dds::DataReaderQos ReaderQos(const Topic& topic);
/// As ReaderQos, with room for everything that writers still keep: for the recorder.
eprosima::fastdds::dds::DataReaderQos RecorderQos(const Topic& topic);
/// Samples that a writer of this kind keeps.
int WriterDepth(TopicKind kind);

}  // namespace mascot
