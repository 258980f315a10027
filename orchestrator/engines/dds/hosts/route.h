#pragma once

#include <string>

#include "experiment/hosts.h"

namespace mascot {

/// The IPv4 address by which a host reaches this one. `seen_from` is our address as the host knows it from ssh; empty:
/// the host does not know it. Throws std::runtime_error if the address cannot be found out.
std::string OurAddress(const HostConfig& host, const std::string& seen_from);

}  // namespace mascot
