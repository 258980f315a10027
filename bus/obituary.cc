#include "bus/obituary.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>

#include "bus/ports.h"
#include "bus/qos.h"

namespace mascot {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int kNumbers = 120;  // of participants of a domain, which have ports of their own

void Add(Bytes& message, std::initializer_list<int> bytes) {
  std::ranges::transform(bytes, std::back_inserter(message), [](int byte) { return static_cast<std::uint8_t>(byte); });
}

}  // namespace

std::vector<std::uint8_t> FarewellOf(const ProcessKey::GuidPrefix& participant) {
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

void SayFarewellFor(const ProcessKey::GuidPrefix& participant, int domain) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return;
  const Bytes message = FarewellOf(participant);
  const auto send = [&](std::uint32_t address, int port) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(address);
    ::sendto(socket, message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  };
  const in_addr loopback{htonl(INADDR_LOOPBACK)};
  ::setsockopt(socket, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
  constexpr std::uint32_t kEverybody = 0xefff0001;  // 239.255.0.1
  send(kEverybody, FirstPort(domain));
  for (int number = 0; number < kNumbers; ++number) send(INADDR_LOOPBACK, DiscoveryPort(domain, number));
  ::close(socket);
}

}  // namespace mascot
