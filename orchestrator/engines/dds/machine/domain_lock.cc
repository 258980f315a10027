#include "orchestrator/engines/dds/machine/domain_lock.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>

#include "bus/ports.h"
#include "bus/shared_memory.h"

namespace mascot {
namespace {

constexpr int kFirstDomain = 2, kLastDomain = 98;

/// The name of the socket that stands for a domain.
std::string NameOf(int domain) { return "mascot-domain-" + std::to_string(domain); }

/// Reserves the domain in this network namespace, as long as the result is open; it is not if another run has it.
Descriptor TakeName(int domain) {
  Descriptor name = MakeLocalSocket(0);             // without SOCK_CLOEXEC: children inherit it
  if (ListenAs(NameOf(domain), name)) return name;  // it listens so that others learn which process has it: HolderOf
  if (errno == EADDRINUSE) return Descriptor();
  throw std::runtime_error(fmt::format("cannot reserve DDS domain {}: {}", domain, std::strerror(errno)));
}

/// Reserves the domain in /dev/shm, where Fast DDS names files by domain and port, whatever the network namespace, as
/// long as the result is open; it is not if another run has it.
Descriptor TakeSharedMemory(int domain) try {
  return ReserveInSharedMemory(domain);
} catch (const std::runtime_error& failure) {
  throw std::runtime_error(fmt::format("cannot reserve DDS domain {} in /dev/shm: {}", domain, failure.what()));
}

/// The process that reserved the domain; nothing if it does not answer.
std::optional<ucred> HolderOf(int domain) {
  const Descriptor caller = MakeLocalSocket(SOCK_NONBLOCK | SOCK_CLOEXEC);
  return ConnectTo(NameOf(domain), caller) ? PeerOf(caller) : std::nullopt;
}

/// Local UDP ports in use on this machine, by which other DDS programs are recognised.
std::set<int> UdpPortsInUse() {
  std::set<int> ports;
  for (const char* table : {"/proc/net/udp", "/proc/net/udp6"}) {
    std::ifstream file(table);
    std::string line;
    std::getline(file, line);  // heading
    while (std::getline(file, line)) {
      std::istringstream fields(line);
      std::string slot, local;
      fields >> slot >> local;
      const auto colon = local.rfind(':');
      if (colon != std::string::npos) ports.insert(std::stoi(local.substr(colon + 1), nullptr, 16));
    }
  }
  return ports;
}

}  // namespace

bool IsUdpPortInUse(int port) { return UdpPortsInUse().contains(port); }

namespace {

bool HasPortIn(const std::set<int>& ports, int first, int end) {
  const auto port = ports.lower_bound(first);
  return port != ports.end() && *port < end;
}

/// "other DDS programs have 1, user alice has 48": which programs and users have the domains that a run may choose
/// from.
std::string Holders() {
  std::map<std::string, int> count;
  for (int domain = kFirstDomain; domain <= kLastDomain; domain += kDomainsPerRun) {
    const auto holder = HolderOf(domain);
    ++count[holder ? "user " + UserName(holder->uid) + " has" : "other DDS programs have"];
  }
  std::string text;
  for (const auto& [who, domains] : count) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", who, domains);
  return text;
}

}  // namespace

DomainLock::DomainLock(int wanted, const std::set<int>& others) : domain_(wanted) {
  if (wanted < 0) {
    TakeAny(others);
    return;
  }
  const Taken taken = Take(wanted);
  if (taken == Taken::kNowhere) return;
  if (taken == Taken::kInSharedMemory)
    throw std::runtime_error(fmt::format(
        "network.domain = {} is in use by a run in another network namespace that shares /dev/shm", wanted));
  const auto holder = HolderOf(wanted);
  throw std::runtime_error(
      fmt::format("network.domain = {} is in use by another run on this machine{}", wanted,
                  holder ? fmt::format(": process {} of user {}", holder->pid, UserName(holder->uid)) : std::string()));
}

DomainLock::Taken DomainLock::Take(int domain) {
  Descriptor name = TakeName(domain);
  if (!name.is_open()) return Taken::kHere;
  Descriptor memory = TakeSharedMemory(domain);
  if (!memory.is_open()) return Taken::kInSharedMemory;
  name_ = std::move(name);
  memory_ = std::move(memory);
  return Taken::kNowhere;
}

void DomainLock::TakeAny(const std::set<int>& others) {
  const std::set<int> busy = UdpPortsInUse();
  for (domain_ = kFirstDomain; domain_ <= kLastDomain; domain_ += kDomainsPerRun) {
    const auto other = others.lower_bound(domain_);
    if (other != others.end() && *other < domain_ + kDomainsPerRun) continue;
    if (HasPortIn(busy, FirstPort(domain_), FirstPort(domain_ + kDomainsPerRun))) continue;
    if (Take(domain_) == Taken::kNowhere) return;
  }
  throw std::runtime_error(fmt::format("no free DDS domain among {}, {}, ..., {}: {}; network.domain may name another",
                                       kFirstDomain, kFirstDomain + kDomainsPerRun, kLastDomain, Holders()));
}

int DomainLock::discovery_port() const { return FirstPort(domain_) + 5; }

}  // namespace mascot
