#pragma once

#include <Eigen/Core>
#include <optional>

#include "orchestrator/theory/linear_team.h"

namespace mascot {

/// Where a linear team without leader meets, as q = p - d, on a graph that does not change: in closed form. Nothing if
/// delays differ, or agents that do not start from rest have any, or only some agents brake.
std::optional<Eigen::Vector3d> MeetingPoint(const Experiment& experiment, const LinearTeam& team, const Graph& graph);
/// Where a leader comes to rest, likewise, if it does.
std::optional<Eigen::Vector3d> RestingPlace(const Experiment& experiment, const LinearTeam& team, int leader);
/// With law.axes = "xy" every agent keeps its own height: the mean of q's z.
double HeldHeight(const Experiment& experiment, const LinearTeam& team);

}  // namespace mascot
