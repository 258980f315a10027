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

}  // namespace mascot
