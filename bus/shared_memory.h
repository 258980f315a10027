#pragma once

#include <string>
#include <vector>

namespace mascot {

/// What dead Fast DDS processes (killed, crashed) left in /dev/shm: files of this user that no other process
/// maps or holds a lock on. For a caller that has no participant (any more).
std::vector<std::string> StaleSharedMemory();
/// Removes them. Safe beside running processes.
void SweepSharedMemory();

}  // namespace mascot
