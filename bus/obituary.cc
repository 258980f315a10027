#include "bus/obituary.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <vector>

#include "bus/ports.h"
#include "bus/qos.h"
#include "system/descriptor.h"

namespace mascot {
namespace {

using Bytes = std::vector<std::uint8_t>;

void Add(Bytes& message, std::initializer_list<int> bytes) {
  std::ranges::transform(bytes, std::back_inserter(message), [](int byte) { return static_cast<std::uint8_t>(byte); });
}

/// What a participant sends to the others when it leaves: a message of RTPS 2.3 with a sample of SPDP (8.5.3), disposed
/// and unregistered.
Bytes FarewellOf(const ProcessKey::GuidPrefix& participant) {
  Bytes message;
  const auto add_prefix = [&] { message.insert(message.end(), participant.value, participant.value + 12); };
  Add(message, {'R', 'T', 'P', 'S', 2, 3, 1, 15});
  add_prefix();
  Add(message, {0x15, 0x03, 52, 0});                   // DATA: little endian, inline QoS and no payload; its size
  Add(message, {0, 0, 16, 0});                         // no flags; octets to the inline QoS
  Add(message, {0, 1, 0, 0xc7, 0, 1, 0, 0xc2});        // the reader and the writer of SPDP
  Add(message, {0, 0, 0, 0, 0xff, 0xff, 0xff, 0x7f});  // a sequence number beyond all of the participant's own
  Add(message, {0x70, 0, 16, 0});                      // PID_KEY_HASH: the participant
  add_prefix();
  Add(message, {0, 0, 1, 0xc1});
  Add(message, {0x71, 0, 4, 0, 0, 0, 0, 3});  // PID_STATUS_INFO: disposed, unregistered
  Add(message, {1, 0, 0, 0});                 // PID_SENTINEL
  return message;
}

}  // namespace

void SayFarewellFor(const ProcessKey::GuidPrefix& participant, int domain) {
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  const Bytes message = FarewellOf(participant);
  const auto send = [&](std::uint32_t address, int port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(address);
    ::sendto(socket.number(), message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  };
  const in_addr loopback{htonl(INADDR_LOOPBACK)};
  ::setsockopt(socket.number(), IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
  send(ntohl(inet_addr(kDiscoveryMulticast)), FirstPort(domain));
  for (int number = 0; number < kParticipantsPerDomain; ++number) send(INADDR_LOOPBACK, DiscoveryPort(domain, number));
}

}  // namespace mascot
