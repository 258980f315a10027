#pragma once

#include <string>
#include <vector>

#include "bus/qos.h"

namespace mascot {

/// Throws std::runtime_error, in words, if this machine lacks an address at which such a participant is to be reached:
/// 127.0.0.1, if the participant uses it, or DomainOptions::address.
void RequireAddresses(const DomainOptions& options);
/// The IPv4 addresses of this machine at which others may reach it: of interfaces that are up, without loopback. Throws
/// std::runtime_error if they cannot be listed.
std::vector<std::string> AddressesForOthers();

}  // namespace mascot
