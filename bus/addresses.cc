#include "bus/addresses.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace mascot {
namespace {

/// An IPv4 address of an interface.
struct Interface {
  std::string name, address;
  bool is_up = false;
};

std::vector<Interface> Interfaces() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0)
    throw std::runtime_error(std::string("cannot list network interfaces: ") + std::strerror(errno));
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> owner(list, freeifaddrs);
  std::vector<Interface> interfaces;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    const bool is_up = (entry->ifa_flags & IFF_UP) != 0;
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) {
      interfaces.push_back({entry->ifa_name, "", is_up});
      continue;
    }
    char text[INET_ADDRSTRLEN] = "";
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(entry->ifa_addr)->sin_addr, text, sizeof text);
    interfaces.push_back({entry->ifa_name, text, is_up});
  }
  return interfaces;
}

bool Has(const std::vector<Interface>& interfaces, const std::string& address) {
  return std::ranges::any_of(interfaces, [&](const Interface& each) { return each.is_up && each.address == address; });
}

constexpr const char* kNone = "none";

/// "127.0.0.1 (lo), 10.0.0.5 (eth0)": the addresses that are up.
std::string AddressesText(const std::vector<Interface>& interfaces) {
  std::string text;
  for (const Interface& each : interfaces)
    if (each.is_up && !each.address.empty())
      text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", each.address, each.name);
  return text.empty() ? kNone : text;
}

void RequireLoopback(const std::vector<Interface>& interfaces) {
  const std::string loopback = "127.0.0.1";
  if (Has(interfaces, loopback)) return;
  const bool is_up = std::ranges::any_of(interfaces, [](const auto& each) { return each.name == "lo" && each.is_up; });
  throw std::runtime_error(fmt::format(
      "the network interface lo {}, by which the processes of a run on one host find each other: as root, `{}`",
      is_up ? "does not have the address " + loopback : "is down",
      is_up ? "ip address add " + loopback + "/8 dev lo" : "ip link set lo up"));
}

}  // namespace

void RequireAddresses(const DomainOptions& options) {
  const std::vector<Interface> interfaces = Interfaces();
  const bool without_udp = options.transport == "shm" && options.role == DiscoveryRole::kPeer;
  if (!without_udp && (options.loopback || options.server.starts_with("127."))) RequireLoopback(interfaces);
  if (!without_udp && AddressesText(interfaces) == kNone)
    throw std::runtime_error("no network interface of this machine that is up has an IPv4 address, not even lo");
  if (options.address.empty() || Has(interfaces, options.address)) return;
  throw std::runtime_error(
      fmt::format("no network interface of this machine that is up has the address {}; there are {}", options.address,
                  AddressesText(interfaces)));
}

std::vector<std::string> AddressesForOthers() {
  std::vector<std::string> addresses;
  for (const Interface& each : Interfaces())
    if (each.is_up && !each.address.empty() && !each.address.starts_with("127.")) addresses.push_back(each.address);
  return addresses;
}

}  // namespace mascot
