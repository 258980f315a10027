#pragma once

#include <string>

#include "experiment/hosts.h"

namespace mascot {

/// The IPv4 address by which a host reaches this one. `seen_from`: our address as the host knows it by itself, by ssh;
/// empty: it does not. Throws std::runtime_error if it cannot be found out.
std::string OurAddress(const HostConfig& host, const std::string& seen_from);

}  // namespace mascot
