#pragma once

#include <string>
#include <vector>

#include "system/local_socket.h"

namespace mascot {

/// In place of a domain for StaleSharedMemory() and SweepSharedMemory(): segments only.
inline constexpr int kNoDomain = -1;

/// Reserves the names of a domain in /dev/shm, whatever the network namespace, as long as the result is open (children
/// inherit it). The result is not open if another process has them. Throws std::runtime_error.
Descriptor ReserveInSharedMemory(int domain);

/// Paths of the files that dead Fast DDS processes (killed or crashed) left in /dev/shm: files of this user that no
/// other process has open, maps or has locked. They are segments, the ports of a run in `domain`, and further ports
/// that a participant takes if it cannot open its own (for example because there are too few threads), unless a run has
/// reserved these. The calling process must not have a DDS participant.
std::vector<std::string> StaleSharedMemory(int domain);
/// Removes the files that are stale now and still stale 50 ms later. Safe while other processes run, also while they
/// start: a process keeps a file open until it maps it. The caller must hold the DomainLock of `domain`: names of
/// ports, unlike those of segments, are used again, and a port that looks stale may be opened just before it is
/// removed.
void SweepSharedMemory(int domain);

}  // namespace mascot
