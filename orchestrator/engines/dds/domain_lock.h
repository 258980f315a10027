#pragma once

#include <string>

namespace mascot {

/// A DDS domain that no other run of this machine uses, for as long as this object or any child that
/// inherited its descriptor lives: a lock on a file in /tmp.
class DomainLock {
 public:
  /// `wanted` < 0 picks a free domain; otherwise that one. Throws std::runtime_error if it is in use, or
  /// if none is free.
  explicit DomainLock(int wanted);
  ~DomainLock();
  DomainLock(const DomainLock&) = delete;
  DomainLock& operator=(const DomainLock&) = delete;

  int domain() const { return domain_; }
  /// A UDP port of this domain that RTPS assigns to no participant: for the run's discovery server.
  int discovery_port() const;

 private:
  int domain_ = -1;
  int descriptor_ = -1;
};

}  // namespace mascot
