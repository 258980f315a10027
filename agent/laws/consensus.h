#pragma once

#include <optional>

#include "agent/laws/waypoint.h"
#include "experiment/experiment.h"

namespace mascot {

struct ConsensusParams {
  double p_gain = 0;
  double v_gain = 0;
  double beta = 0;
  std::optional<WaypointParams> leader_flight;  ///< absent: the leader's acceleration is 0
};

inline constexpr LawParameter kConsensusParameters[] = {
    {"p_gain", "1.0", "[0, 1000], 1/s^2", "pull towards each neighbour, times its weight"},
    {"v_gain", "0.0", "[0, 1000], 1/s", "pull towards each neighbour's velocity, times its weight"},
    {"beta", "1.0", "[0, 1000], 1/s", "damping of the agent's own velocity"},
    {"leader", "0", "0..N", "agent that leads and listens to nobody; 0: none"},
    {"leader_waypoints_m", "", "[[x, y, z], ...], m", "the leader flies these, as the waypoint law does"},
    {"leader_p_gain", "1.0", "[0, 1000], 1/s^2", "with leader_waypoints_m, as the waypoint law's p_gain"},
    {"leader_d_gain", "1.0", "[0, 1000], 1/s", "likewise d_gain"},
    {"leader_arrival_radius_m", "0.2", "(0, 1000], m", "likewise arrival_radius_m"},
    {"leader_dwell_s", "1.0", "[0, 1e6], s", "likewise dwell_s"},
    {"leader_times_s", "", "increasing, >= 0, s", "likewise times_s"},
};

ConsensusParams ReadConsensus(LawConfig& law);

}  // namespace mascot
