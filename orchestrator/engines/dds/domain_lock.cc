#include "orchestrator/engines/dds/domain_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <stdexcept>

namespace mascot {
namespace {

constexpr const char* kFolder = "/tmp/mascot-domains";  // not $TMPDIR: every run of the machine must see it
constexpr int kFirstDomain = 2, kLastDomain = 98;
constexpr int kDomainStep = 2;  // more than 120 participants run over into the next domain's ports
constexpr int kPortBase = 7400, kPortsPerDomain = 250;  // RTPS 2.2, section 9.6.1

int FirstPort(int domain) { return kPortBase + kPortsPerDomain * domain; }

/// Opens the domain's lock file, creating it if necessary. Without O_CLOEXEC: children inherit the lock.
int OpenLockFile(int domain) {
  if (mkdir(kFolder, 01777) == 0) chmod(kFolder, 01777);  // the umask applies to mkdir's mode
  const std::string path = std::string(kFolder) + "/" + std::to_string(domain);
  int descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW);
  if (descriptor < 0 && errno == ENOENT) descriptor = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CREAT, 0644);
  if (descriptor < 0) throw std::runtime_error("cannot open " + path + ": " + std::strerror(errno));
  return descriptor;
}

/// Locks the domain. Returns the descriptor that holds the lock, or -1 if another run holds it.
int TryLock(int domain) {
  const int descriptor = OpenLockFile(domain);
  if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
  close(descriptor);
  return -1;
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

bool HasPortIn(const std::set<int>& ports, int first, int end) {
  const auto port = ports.lower_bound(first);
  return port != ports.end() && *port < end;
}

}  // namespace

DomainLock::DomainLock(int wanted) {
  if (wanted >= 0) {
    domain_ = wanted;
    descriptor_ = TryLock(wanted);
    if (descriptor_ < 0)
      throw std::runtime_error("network.domain = " + std::to_string(wanted) +
                               " is in use by another run on this machine");
    return;
  }
  const std::set<int> busy = UdpPortsInUse();
  for (int domain = kFirstDomain; domain <= kLastDomain; domain += kDomainStep) {
    if (HasPortIn(busy, FirstPort(domain), FirstPort(domain + kDomainStep))) continue;
    descriptor_ = TryLock(domain);
    if (descriptor_ < 0) continue;
    domain_ = domain;
    return;
  }
  throw std::runtime_error("no free DDS domain: too many runs on this machine at once");
}

DomainLock::~DomainLock() { close(descriptor_); }

int DomainLock::discovery_port() const { return FirstPort(domain_) + 5; }

}  // namespace mascot
