#pragma once

#include <string>
#include <vector>

namespace mascot {

/// Reserves a DDS domain, so that no other run on this machine uses it, of this user or another: neither in the network
/// namespace, by the name of a socket, nor in /dev/shm, which several of them may share, by a lock on a byte of that
/// folder. It lasts as long as this object, or a process that inherited its descriptors (Janitor), and leaves nothing.
class DomainLock {
 public:
  /// Reserves domain `wanted`; if `wanted` < 0, any free domain. Throws std::runtime_error if it is in use or none is
  /// free, and says who has it, or them.
  explicit DomainLock(int wanted);
  ~DomainLock();
  DomainLock(const DomainLock&) = delete;
  DomainLock& operator=(const DomainLock&) = delete;

  int domain() const { return domain_; }
  /// What holds the reservation.
  const std::vector<int>& descriptors() const { return descriptors_; }
  /// UDP port for the run's discovery server; RTPS assigns it to no participant of this domain.
  int discovery_port() const;

 private:
  void TakeAny();

  int domain_ = -1;
  std::vector<int> descriptors_;
};

}  // namespace mascot
