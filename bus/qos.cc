#include "bus/qos.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "base/number.h"
#include "bus/ports.h"
#include "idl/schemas.h"

namespace mascot {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastdds::rtps;
using eprosima::fastrtps::Duration_t;
using eprosima::fastrtps::rtps::DiscoveryProtocol;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

// --- topics: what their table says (idl/topics.cc) -------------------------------------------------------

template <class Qos>
void SetCommon(Qos& qos, const TopicTraits& traits, int depth, Redelivery redelivery) {
  qos.reliability().kind =
      redelivery == Redelivery::kOnDemand ? dds::BEST_EFFORT_RELIABILITY_QOS : dds::RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = traits.for_late_joiners ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = depth;
  qos.resource_limits().max_samples = 0;  // unlimited: the depth is the limit
  qos.resource_limits().max_instances = 1;
  qos.resource_limits().max_samples_per_instance = depth;
  qos.resource_limits().allocated_samples = std::min(depth, 16);
  qos.data_sharing().off();  // no faster for samples of this size, and leaves files behind
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

/// Entity id of the readers on an agent's topic, the same in every process; -1: Fast DDS picks one. If all matched
/// readers have the same id, Fast DDS writes it into the message. Otherwise the receiving process tries each of its
/// readers, hundreds in the recorder's process.
std::int16_t ReaderNumber(const Topic& topic) {
  constexpr int kFirst = 256;    // smaller ids are those that Fast DDS picks
  constexpr int kAgents = 4600;  // those of seven kinds, the first of TopicKind; vehicles are few
  static_assert(static_cast<int>(TopicKind::kState) == 6 && kFirst + 7 * kAgents < 32768);
  const bool of_agents = topic.agent > 0 && topic.agent < kAgents && topic.kind <= TopicKind::kState;
  if (!of_agents) return -1;
  return static_cast<std::int16_t>(kFirst + kAgents * static_cast<int>(topic.kind) + topic.agent);
}

dds::DataReaderQos MakeReaderQos(const Topic& topic, int depth, Redelivery redelivery) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  SetCommon(qos, topic.traits(), depth, redelivery);
  qos.endpoint().entity_id = ReaderNumber(topic);
  if (redelivery == Redelivery::kOften) qos.reliable_reader_qos().times.heartbeatResponseDelay = Duration_t(0, 0);
  return qos;
}

// --- transports: one row each -------------------------------------------------------------------------

/// Bytes for samples that are sent and not read yet. The recorder may be 64 ticks behind: an agent's commands and
/// messages of that time are 65 KB.
std::uint32_t SegmentSize(const DomainOptions& options) {
  return 128 * 1024 + 32 * 1024 * static_cast<std::uint32_t>(options.participants);
}

/// Number of samples that wait to be received.
std::uint32_t QueueCapacity(const DomainOptions& options) {
  return std::max<std::uint32_t>(512, 64 * static_cast<std::uint32_t>(options.participants));
}

std::shared_ptr<rtps::TransportDescriptorInterface> SharedMemory(const DomainOptions& options) {
  auto transport = std::make_shared<rtps::SharedMemTransportDescriptor>();
  transport->segment_size(SegmentSize(options));
  transport->port_queue_capacity(QueueCapacity(options));
  return transport;
}

std::shared_ptr<rtps::TransportDescriptorInterface> Udp(const DomainOptions& options) {
  auto transport = std::make_shared<rtps::UDPv4TransportDescriptor>();
  if (options.loopback || !options.address.empty()) transport->interfaceWhiteList.push_back("127.0.0.1");
  if (!options.address.empty()) transport->interfaceWhiteList.push_back(options.address);
  // The kernel's default of about 200 KB loses samples when a hundred agents send their commands at once. The kernel
  // grants at most its own limit.
  transport->receiveBufferSize = transport->sendBufferSize = 4 * 1024 * 1024;
  transport->maxInitialPeersRange = kParticipantsPerDomain;
  return transport;
}

struct Transport {
  std::string_view name;
  bool shared_memory;
  bool udp;
};

constexpr Transport kTransports[] = {
    {"auto", true, true},  // shared memory on one host, UDP between hosts
    {"udp", false, true},  // UDP even on one host: for peers with an incompatible shared memory
    {"shm", true, false},  // never leaves this host
};

// --- discovery ----------------------------------------------------------------------------------------

Locator_t ServerLocator(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  const auto text = colon == std::string::npos ? std::string_view() : std::string_view(address).substr(colon + 1);
  const std::uint16_t port = NumberFrom<std::uint16_t>(text).value_or(0);
  Locator_t locator;
  if (port == 0 || !IPLocator::setIPv4(locator, address.substr(0, colon)))
    throw std::invalid_argument("--discovery: expected IP-ADDRESS:PORT, got '" + address + "'");
  IPLocator::setPhysicalPort(locator, port);
  return locator;
}

/// GUID prefix of the discovery server at this address, made from its port: it must differ between runs on one host.
eprosima::fastrtps::rtps::GuidPrefix_t ServerPrefix(const Locator_t& server) {
  eprosima::fastrtps::rtps::GuidPrefix_t prefix;
  std::ostringstream text;
  const unsigned port = IPLocator::getPhysicalPort(server);
  text << "44.53.4d.41.53.43.4f.54.00.00." << std::hex << (port >> 8) << "." << (port & 255);
  std::istringstream(text.str()) >> prefix;
  return prefix;
}

/// Fast DDS 2.9 creates its shared-memory sender when it first discovers a peer that has shared memory, and aborts (an
/// assertion in its statistics) if another thread is sending at that moment. With this initial peer the sender exists
/// from the start. No process listens there: it is the last port of the domain, so that what a killed process leaves of
/// it is swept with the rest.
Locator_t NobodyInSharedMemory(int domain) {
  Locator_t nobody(LOCATOR_KIND_SHM, static_cast<std::uint32_t>(FirstPort(domain) + kPortsPerDomain - 1));
  nobody.address[0] = 'U';
  return nobody;
}

Locator_t UdpLocator(const std::string& address) {
  Locator_t locator;  // its port: that of this participant's number
  IPLocator::setIPv4(locator, address);
  return locator;
}

/// Messages of discovery come by UDP alone. If a participant leaves while its first message in shared memory is still
/// unread, Fast DDS 2.9 makes the reader deaf: it looks for the segment of that participant again and again, and reads
/// no other message there. A tool that lists topics, for example, leaves at once.
///
/// With credentials, this also lets discovery and handshakes among the processes of a run come in one thread. A
/// participant begins a handshake as soon as it hears of another; if its first word came in another thread, the other
/// might still be busy with discovering it, and Fast DDS drops the word, to say it again a second later. Whoever does
/// not know the numbers of a run's processes finds them by multicast, as without credentials.
void ReceiveDiscoveryByUdp(dds::DomainParticipantQos& qos, const DomainOptions& options) {
  auto& builtin = qos.wire_protocol().builtin;
  auto& locators = builtin.metatrafficUnicastLocatorList;
  locators.push_back(UdpLocator("127.0.0.1"));
  if (!options.loopback) locators.push_back(UdpLocator(options.address.empty() ? "0.0.0.0" : options.address));
  Locator_t multicast = UdpLocator(kDiscoveryMulticast);
  IPLocator::setPhysicalPort(multicast, static_cast<std::uint16_t>(FirstPort(options.domain)));
  builtin.metatrafficMulticastLocatorList.push_back(multicast);  // Fast DDS adds none where others are given
}

void SetDiscovery(dds::DomainParticipantQos& qos, const DomainOptions& options) {
  auto& builtin = qos.wire_protocol().builtin;
  builtin.mutation_tries = 1000;  // with the default, 100, the 101st participant of a host receives nothing
  builtin.typelookup_config.use_client = false;
  builtin.typelookup_config.use_server = false;
  if (options.role == DiscoveryRole::kPeer) {
    // Announce often at first, so that the start does not wait for the regular period of seconds.
    builtin.discovery_config.initial_announcements.count = 20;
    builtin.discovery_config.initial_announcements.period = Duration_t(0, 100'000'000);
    if (options.peers.empty()) return;
    builtin.discovery_config.initial_announcements.period = Duration_t(0, 50'000'000);  // they go to these few only
    builtin.initialPeersList.push_back(NobodyInSharedMemory(options.domain));
    for (const int number : options.peers) {
      Locator_t peer;
      if (!IPLocator::setIPv4(peer, options.peers_at))
        throw std::invalid_argument("--peers-at: expected an IPv4 address, got '" + options.peers_at + "'");
      IPLocator::setPhysicalPort(peer, DiscoveryPort(options.domain, number));
      if (number != options.number) builtin.initialPeersList.push_back(peer);
    }
    return;
  }
  const Locator_t locator = ServerLocator(options.server);
  if (options.role == DiscoveryRole::kServer) {
    builtin.discovery_config.discoveryProtocol = DiscoveryProtocol::SERVER;
    qos.wire_protocol().prefix = ServerPrefix(locator);
    builtin.metatrafficUnicastLocatorList.push_back(locator);
    // A server answers those who come. At times of its own it would announce itself to all that it knows: Fast DDS 2.9
    // ends the process by an assertion if that is just when it has heard of one, but cannot send to it yet.
    builtin.discovery_config.initial_announcements.count = 0;
    builtin.discovery_config.leaseDuration = eprosima::fastrtps::c_TimeInfinite;
    builtin.discovery_config.leaseDuration_announcementperiod = eprosima::fastrtps::c_TimeInfinite;
    return;
  }
  builtin.initialPeersList.push_back(
      NobodyInSharedMemory(options.domain));  // clients announce themselves to their server only
  builtin.discovery_config.discoveryServer_client_syncperiod = Duration_t(0, 50'000'000);  // it is 450 ms
  const bool client = options.role == DiscoveryRole::kClient;
  builtin.discovery_config.discoveryProtocol = client ? DiscoveryProtocol::CLIENT : DiscoveryProtocol::SUPER_CLIENT;
  eprosima::fastdds::rtps::RemoteServerAttributes server;
  server.guidPrefix = ServerPrefix(locator);
  server.metatrafficUnicastLocatorList.push_back(locator);
  builtin.discovery_config.m_DiscoveryServers.push_back(server);
}

}  // namespace

// The specification of RTPS, 9.6.1.1: PB + DG * domain + d1 + PG * number.
std::uint16_t DiscoveryPort(int domain, int number) {
  return static_cast<std::uint16_t>(FirstPort(domain) + 10 + 2 * number);
}

std::span<const std::string_view> TransportNames() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const Transport& row : kTransports) all.push_back(row.name);
    return all;
  }();
  return names;
}

namespace {

const Transport& TransportOf(const DomainOptions& options) {
  const auto row = std::find_if(std::begin(kTransports), std::end(kTransports),
                                [&](const Transport& transport) { return transport.name == options.transport; });
  if (row != std::end(kTransports)) return *row;
  std::string names;
  for (const Transport& transport : kTransports) names += std::string(transport.name) + ", ";
  throw std::invalid_argument("--transport: expected one of " + names + "got '" + options.transport + "'");
}

/// Discovery servers exchange discovery data only: no use for shared memory.
bool UsesSharedMemory(const DomainOptions& options) {
  return TransportOf(options).shared_memory && options.role != DiscoveryRole::kServer;
}

const Duration_t kSeldomAsked(0, 200'000'000), kOftenAsked(0, 20'000'000), kAlwaysAsked(0, 2'000'000),
    kBelievedOnItsWay(0, 5'000'000);

// How a writer finds out that a sample was lost, and when it sends the sample again: once a heartbeat asked the reader,
// which comes periodically while a sample is not confirmed, and once the writer no longer believes that the sample is
// on its way. In lockstep, a tick waits for this.
void SetRedelivery(const TopicTraits& traits, Redelivery redelivery, dds::RTPSReliableWriterQos& reliable) {
  reliable.times.heartbeatPeriod = kSeldomAsked;
  if (redelivery == Redelivery::kAlways) reliable.times.heartbeatPeriod = kAlwaysAsked;
  if (redelivery == Redelivery::kAlways || traits.rhythm == TopicRhythm::kRare) return;
  // 0 would wake the event thread at every write, and so does a short time. Where nothing gets lost, it may be long.
  reliable.times.nackSupressionDuration = Duration_t(1, 0);
  reliable.disable_heartbeat_piggyback = true;
  if (redelivery != Redelivery::kOften) return;
  reliable.times.nackSupressionDuration = kBelievedOnItsWay;
  reliable.times.nackResponseDelay = Duration_t(0, 0);
  if (traits.per_process) reliable.times.heartbeatPeriod = kOftenAsked;  // topics of agents are too many
}

}  // namespace

std::uint64_t SharedMemoryNeeded(const DomainOptions& options) {
  if (!UsesSharedMemory(options)) return 0;
  // Sizes of the files of Fast DDS 2.9: a segment with a table of what waits, two ports, and perhaps one more, of a
  // peer that is not there.
  constexpr std::uint64_t kPage = 4096, kTableRow = 48, kQueueRow = 20, kPort = 42ULL * 1024;
  const auto pages = [](std::uint64_t bytes) { return (bytes + kPage - 1) / kPage * kPage; };
  const std::uint64_t rows = QueueCapacity(options);
  const std::uint64_t locks = 3 * kPage;
  return pages(SegmentSize(options) + kTableRow * rows + kPage) + 3 * pages(kQueueRow * rows + kPort) + locks;
}

dds::DomainParticipantQos ParticipantQos(const DomainOptions& options) {
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  qos.name(options.name);
  qos.wire_protocol().participant_id = options.number;
  qos.transport().use_builtin_transports = false;
  if (UsesSharedMemory(options)) qos.transport().user_transports.push_back(SharedMemory(options));
  if (TransportOf(options).udp || options.role != DiscoveryRole::kPeer)
    qos.transport().user_transports.push_back(Udp(options));
  SetDiscovery(qos, options);
  if (options.role != DiscoveryRole::kServer && TransportOf(options).udp) ReceiveDiscoveryByUdp(qos, options);
  if (options.patient) qos.wire_protocol().builtin.discovery_config.leaseDuration = eprosima::fastrtps::c_TimeInfinite;
  return qos;
}

dds::DataWriterQos WriterQos(TopicKind kind, Redelivery redelivery) {
  const TopicTraits& traits = TraitsOf(kind);
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  SetCommon(qos, traits, traits.writer_depth, redelivery);
  qos.publish_mode().kind = traits.is_large ? dds::ASYNCHRONOUS_PUBLISH_MODE : dds::SYNCHRONOUS_PUBLISH_MODE;
  const std::string type = fmt::format("typehash={};", SchemaOf(kind).type_hash);  // as ROS 2 tells it
  qos.user_data().setValue({type.begin(), type.end()});
  SetRedelivery(traits, redelivery, qos.reliable_writer_qos());
  return qos;
}

dds::DataReaderQos ReaderQos(const Topic& topic, Redelivery redelivery) {
  return MakeReaderQos(topic, topic.traits().reader_depth, redelivery);
}

dds::DataReaderQos RecorderQos(const Topic& topic, Redelivery redelivery) {
  return MakeReaderQos(topic, topic.traits().writer_depth, redelivery);
}

}  // namespace mascot
