#pragma once

namespace mascot {

// The UDP ports of DDS domains (RTPS 2.2, section 9.6.1). Fast DDS gives its shared-memory ports the same numbers.
inline constexpr int kPortBase = 7400, kPortsPerDomain = 250;
/// Domains whose ports a run may use: more than 120 participants run over into the ports of the next domain.
inline constexpr int kDomainsPerRun = 2;

constexpr int FirstPort(int domain) { return kPortBase + kPortsPerDomain * domain; }

}  // namespace mascot
