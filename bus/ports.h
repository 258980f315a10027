#pragma once

namespace mascot {

// The UDP ports of DDS domains (RTPS 2.2, section 9.6.1). Fast DDS gives its shared-memory ports the same numbers.
inline constexpr int kPortBase = 7400, kPortsPerDomain = 250;
/// Participants that have ports of their own in a domain; their numbers (DomainOptions::number) begin with 0.
inline constexpr int kParticipantsPerDomain = 120;
/// Domains whose ports a run may use: more participants run over into the ports of the next domain.
inline constexpr int kDomainsPerRun = 2;

/// Where participants look for others by multicast, at FirstPort() of their domain (section 9.6.1.4).
inline constexpr char kDiscoveryMulticast[] = "239.255.0.1";

constexpr int FirstPort(int domain) { return kPortBase + kPortsPerDomain * domain; }

}  // namespace mascot
