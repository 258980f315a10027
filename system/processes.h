#pragma once

#include <sys/types.h>

#include <vector>

namespace mascot {

/// The numbers of the processes that /proc shows to the caller, itself included. Some may have ended since.
std::vector<pid_t> Processes();

}  // namespace mascot
