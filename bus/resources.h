#pragma once

#include <cstdint>

namespace mascot {

/// What the processes of a run that join a DDS domain need of this machine, together.
struct ResourceNeeds {
  std::uint64_t shared_memory = 0;  ///< bytes of /dev/shm
  int processes = 1;                ///< number of processes that join the domain
  int descriptors = 64;             ///< file descriptors of the process that needs most
};

// These are checked before the start. Otherwise Fast DDS would end processes by a signal, without a message, or create
// participants that hear nothing, and the run would wait in vain for a process to be found.

/// Throws std::runtime_error, in words, if this machine does not grant these processes memory, descriptors or threads.
/// The soft limit of descriptors is raised if the hard one allows it.
void RequireResources(const ResourceNeeds& needs);

}  // namespace mascot
