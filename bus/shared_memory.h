#pragma once

#include <string>
#include <vector>

namespace mascot {

/// Paths of the files that dead Fast DDS processes (killed or crashed) left in /dev/shm: files of this user that no
/// other process maps and no process has locked. The calling process must have no DDS participant (any more).
std::vector<std::string> StaleSharedMemory();
/// Removes the files that are stale now and still stale 50 ms later. Safe while other processes run.
void SweepSharedMemory();

}  // namespace mascot
