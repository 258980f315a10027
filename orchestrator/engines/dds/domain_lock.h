#pragma once

#include <string>

namespace mascot {

/// Reserves a DDS domain, so that no other run on this machine uses it, of this user or another: the name of a socket,
/// of which there is one in each network namespace. It lasts as long as this object, or a process that inherited its
/// descriptor (Janitor), and leaves nothing.
class DomainLock {
 public:
  /// Reserves domain `wanted`; if `wanted` < 0, any free domain. Throws std::runtime_error if it is in use or none is
  /// free, and says who has it, or them.
  explicit DomainLock(int wanted);
  ~DomainLock();
  DomainLock(const DomainLock&) = delete;
  DomainLock& operator=(const DomainLock&) = delete;

  int domain() const { return domain_; }
  int descriptor() const { return descriptor_; }
  /// UDP port for the run's discovery server; RTPS assigns it to no participant of this domain.
  int discovery_port() const;

 private:
  void TakeAny();

  int domain_ = -1;
  int descriptor_ = -1;
};

}  // namespace mascot
