#pragma once

#include <optional>
#include <vector>

#include "agent/laws/waypoint.h"
#include "experiment/experiment.h"

namespace mascot {

/// The tree that min-max consensus runs on, and the bounds on it.
struct MinmaxParams {
  std::vector<double> beta;         ///< by id - 1: largest acceleration per axis (m/s^2)
  std::vector<int> parent;          ///< by id - 1: whom the agent follows; 0 for the root
  std::vector<double> parent_beta;  ///< by id - 1: the bound that the agent expects of its parent; 0 for the root
  double boundary_layer_m = 0;
  std::optional<WaypointParams> root_flight;  ///< absent: the root's acceleration is 0
};

inline constexpr LawParameter kMinmaxParameters[] = {
    {"leader", "*", "1..N", "root of the spanning tree"},
    {"beta", "*", "(0, 1000], m/s^2", "largest acceleration per axis: one number, or a list by id"},
    {"weak_edges", "\"refuse\"", "refuse | root",
     "an edge whose child is not stronger than its parent: refuse, or expect the root's bound of every parent"},
    {"boundary_layer", "0.0", "[0, 1000], m", "distance to the parent within which sgn gives way to a smooth function"},
    {"leader_waypoints_m", "", "[[x, y, z], ...], m", "the root flies these as the waypoint law does, within its beta"},
    {"leader_p_gain", "1.0", "[0, 1000], 1/s^2", "with leader_waypoints_m, as the waypoint law's p_gain"},
    {"leader_d_gain", "1.0", "[0, 1000], 1/s", "likewise d_gain"},
    {"leader_arrival_radius_m", "0.2", "(0, 1000], m", "likewise arrival_radius_m"},
    {"leader_dwell_s", "1.0", "[0, 1e6], s", "likewise dwell_s"},
    {"leader_times_s", "", "increasing, >= 0, s", "likewise times_s"},
};

MinmaxParams ReadMinmax(const Experiment& experiment, LawConfig& law);

}  // namespace mascot
