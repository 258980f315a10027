#pragma once

#include <sys/types.h>

#include <vector>

namespace mascot {

// Laws may start processes, and these others. None of them outlives the run: whoever runs laws adopts what descends
// from it, in whatever session or process group, and kills it at its end.

/// From now on processes that descend from this one and have lost their parent become its children, not those of init.
void AdoptDescendants();
/// Kills all processes that descend from this one, without `spared`, and without ssh, which may have left a connection
/// for its user (ControlPersist). Gives up after 2 s. The caller has reaped the children that it knows.
void KillDescendants(const std::vector<pid_t>& spared = {});

/// Gives a mark to what this process starts from now on: a variable of the environment, which programs hand on to those
/// that they start. So it is found also when its parents have died.
void MarkDescendants();
/// Kills the processes of this user that bear the mark with which this process was started, without this one and ssh.
/// Gives up after 2 s. For who outlives the marker (Janitor); what has cleared its environment is not found.
void KillMarked();

}  // namespace mascot
