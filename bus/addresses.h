#pragma once

#include "bus/qos.h"

namespace mascot {

/// Throws std::runtime_error, in words, if this machine lacks an address at which such a participant is to be reached:
/// 127.0.0.1, if the participant uses it, or DomainOptions::address.
void RequireAddresses(const DomainOptions& options);

}  // namespace mascot
