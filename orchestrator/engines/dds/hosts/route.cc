#include "orchestrator/engines/dds/hosts/route.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>

#include <optional>
#include <stdexcept>

#include "system/local_socket.h"

namespace mascot {
namespace {

/// Our IPv4 address as a host sees it that has `address`: that of the route there. Empty: there is none.
std::string OurAddressFor(const in_addr& address) {
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in there{};
  there.sin_family = AF_INET;
  there.sin_port = htons(9);  // nothing is sent
  there.sin_addr = address;
  sockaddr_in here{};
  socklen_t size = sizeof here;
  if (connect(socket.number(), reinterpret_cast<const sockaddr*>(&there), sizeof there) != 0 ||
      getsockname(socket.number(), reinterpret_cast<sockaddr*>(&here), &size) != 0)
    return "";
  char text[INET_ADDRSTRLEN];
  return inet_ntop(AF_INET, &here.sin_addr, text, sizeof text) == nullptr ? "" : text;
}

/// Whether this host has an interface with that address, by which another host may reach it.
bool IsOurs(const in_addr& address) {
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr = address;
  const bool is_loopback = (ntohl(address.s_addr) >> 24U) == IN_LOOPBACKNET;
  return !is_loopback && bind(socket.number(), reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0;
}

/// The address of a host by its name; nothing if it has none.
std::optional<in_addr> AddressOf(const std::string& name) {
  addrinfo wanted{}, *found = nullptr;
  wanted.ai_family = AF_INET;
  if (getaddrinfo(name.substr(name.find('@') + 1).c_str(), nullptr, &wanted, &found) != 0) return std::nullopt;
  const in_addr address = reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr;
  freeaddrinfo(found);
  return address;
}

}  // namespace

std::string OurAddress(const HostConfig& host, const std::string& seen_from) {
  std::string ours;
  in_addr theirs{};
  if (!host.address.empty() && inet_pton(AF_INET, host.address.c_str(), &theirs) == 1)
    ours = OurAddressFor(theirs);
  else if (inet_pton(AF_INET, seen_from.c_str(), &theirs) == 1 && IsOurs(theirs))  // and not that of a jump host
    ours = seen_from;
  else if (const auto address = AddressOf(host.name))
    ours = OurAddressFor(*address);
  if (!ours.empty()) return ours;
  throw std::runtime_error(
      fmt::format("host {}: expected hosts.address, because neither its launch command nor its "
                  "name tells by which address it reaches this host",
                  host.name));
}

}  // namespace mascot
