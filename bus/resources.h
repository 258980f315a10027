#pragma once

#include <cstdint>

#include "bus/qos.h"

namespace mascot {

/// What processes that join a DDS domain need of this machine, together.
struct ResourceNeeds {
  std::uint64_t shared_memory = 0;  ///< bytes of /dev/shm
  int processes = 1;                ///< that join the domain
  int descriptors = 64;             ///< file descriptors of one process, the one that has most
};

// Asked before the start: Fast DDS would end processes by a signal, without a word, or make participants that hear
// nothing, and the run would wait in vain for somebody to be found.

/// Throws std::runtime_error, in words, if this machine does not grant these processes memory, descriptors or threads.
/// The soft limit of descriptors is raised if the hard one allows it.
void RequireResources(const ResourceNeeds& needs);
/// Throws std::runtime_error, in words, if an address by which such a participant is to be reached is not there:
/// 127.0.0.1, if it uses that, or DomainOptions::address.
void RequireAddresses(const DomainOptions& options);

}  // namespace mascot
