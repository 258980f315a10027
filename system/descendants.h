#pragma once

#include <sys/types.h>

#include <vector>

namespace mascot {

// Laws may start processes, and these may start others. None of them outlives the run: a process that runs laws adopts
// all processes that descend from it, in whatever session or process group, and kills them at its end.

/// From now on processes that descend from this one and have lost their parent become its children, not those of init.
void AdoptDescendants();
/// Kills all processes that descend from this one, but not `spared` nor ssh, which may have left a connection for its
/// user (ControlPersist), nor what descends from these. Gives up after 2 s. The caller must have reaped the children
/// that it knows.
void KillDescendants(const std::vector<pid_t>& spared = {});

/// Gives a mark to all processes that this process starts from now on: a variable of the environment, which programs
/// hand on to the programs that they start. By it they are found even after their parents have died.
void MarkDescendants();
/// Kills all processes with the mark with which this process was started, but not this one nor ssh. Gives up after 2 s.
/// For a process that outlives the one that gave the mark (Janitor). Processes that have cleared their environment are
/// not found.
void KillMarked();

}  // namespace mascot
