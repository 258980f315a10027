#pragma once

#include "bus/process_key.h"

namespace mascot {

/// Says farewell for a participant of this machine, which has died, to all participants that others discover at
/// 127.0.0.1 in the domain. Who is not there does not matter; what gets lost costs the time until the lease is over.
///
/// A participant that dies without leaving counts as a reader of its peers until its lease is over (20 s). If it dies
/// while it handles a sample, Fast DDS does not see that nobody takes anything out of its queue in shared memory any
/// more: samples fill that queue, and with it the memory of those who send them, until they drop samples to anybody.
void SayFarewellFor(const ProcessKey::GuidPrefix& participant, int domain);

}  // namespace mascot
