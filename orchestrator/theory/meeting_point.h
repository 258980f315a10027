#pragma once

#include <Eigen/Core>
#include <optional>

#include "orchestrator/theory/linear_team.h"

namespace mascot {

/// Where a linear team without leader meets on a constant graph, as q = p - d in W (m); closed form, derived in
/// meeting_point.cc. Nothing if the graph has no spanning tree, if delays differ, if there are delays and agents do not
/// start from rest, or if no agent with gamma_i > 0 has damping (except from rest, with agents that are alike).
std::optional<Eigen::Vector3d> MeetingPoint(const Experiment& experiment, const LinearTeam& team, const Graph& graph);
/// Where the leader comes to rest, as q in W (m); nothing if it does not.
std::optional<Eigen::Vector3d> RestingPlace(const Experiment& experiment, const LinearTeam& team, int leader);
/// Mean z of all q (m). With law.axes = "xy" every agent keeps its own height.
double HeldHeight(const Experiment& experiment, const LinearTeam& team);

}  // namespace mascot
