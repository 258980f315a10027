#pragma once

#include <array>
#include <set>

#include "system/local_socket.h"

namespace mascot {

/// Whether a program of this machine, or of this network namespace, has this UDP port.
bool IsUdpPortInUse(int port);

/// Reserves a DDS domain, so that no other run on this machine uses it, of this user or another: neither in the network
/// namespace, by the name of a socket, nor in /dev/shm, which several of them may share, by a lock on a byte of that
/// folder. It lasts as long as this object, or a process that inherited its descriptors (Janitor), and leaves nothing.
class DomainLock {
 public:
  /// Reserves domain `wanted`; if `wanted` < 0, any free domain that is none of `others`. Throws std::runtime_error if
  /// it is in use or none is free; the message names the user that has it, or them.
  explicit DomainLock(int wanted, const std::set<int>& others = {});

  int domain() const { return domain_; }
  /// The descriptor that holds the reservation.
  std::array<int, 2> descriptors() const { return {name_.number(), memory_.number()}; }
  /// UDP port for the run's discovery server; RTPS assigns it to no participant of this domain.
  int discovery_port() const;

 private:
  /// Where a domain is taken.
  enum class Taken { kNowhere, kHere, kInSharedMemory };

  /// Reserves the domain, unless another run has it.
  Taken Take(int domain);
  void TakeAny(const std::set<int>& others);

  int domain_ = -1;
  Descriptor name_, memory_;
};

}  // namespace mascot
