#pragma once

#include <optional>

#include "agent/laws/parts/waypoint_flight.h"
#include "experiment/experiment.h"

namespace mascot {

struct ConsensusParams : LawParams {
  double p_gain = 0;                            ///< 1/s^2
  double v_gain = 0;                            ///< 1/s
  double beta = 0;                              ///< 1/s
  std::optional<WaypointParams> leader_flight;  ///< absent: the leader's acceleration is 0
};

/// The keys that consensus and formation (which is consensus on p_i - d_i) share: all but the pull of the positions.
inline constexpr auto kVelocityAndLeaderParameters = Joined(
    std::array{
        key::Number("v_gain", kGain, "pull towards each neighbour's velocity, times its weight")
            .Default("0.0")
            .Unit("1/s")
            .Live(),
        key::Number("beta", kGain, "damping of the agent's own velocity").Default("1.0").Unit("1/s").Live(),
        key::Integer("leader", 0, kMaxAgents, "agent that leads, and uses nothing of what it hears, 1..N; 0: none")
            .Default("0"),
    },
    kLeaderFlightParameters);

inline constexpr auto kConsensusParameters = Joined(
    std::array{
        key::Number("p_gain", kGain, "pull towards each neighbour, times its weight")
            .Default("1.0")
            .Unit("1/s^2")
            .Live(),
    },
    kVelocityAndLeaderParameters);

/// Reads the keys of kConsensusParameters into `params`, for consensus and formation. Mistakes are noted in `section`.
void ReadGains(const LawConfig& law, Section& section, ConsensusParams& params);
LinearForm LinearFormOf(const ConsensusParams& params);
/// How the leader flies in the laws consensus and formation.
const std::optional<WaypointParams>& FlightOfLeader(const LawConfig& law);

}  // namespace mascot
