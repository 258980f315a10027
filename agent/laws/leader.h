#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "agent/laws/waypoint_flight.h"
#include "experiment/experiment.h"

namespace mascot {

/// How the leader of a law flies; nullopt: its acceleration is 0.
using LeaderFlight = const std::optional<WaypointParams>&(const LawConfig& law);
/// Makes the law of a leader, which does not use what it hears: it keeps its velocity (a = 0), or flies waypoints.
std::unique_ptr<Law> MakeLeader(LeaderFlight* flight_of, const AgentConfig& agent);
/// LawEntry::go_to for laws with such a leader.
std::map<std::string, Value> GoToOfLeader(LeaderFlight* flight_of, const AgentConfig& agent, const Eigen::Vector3d& p_W,
                                          double t_s);

}  // namespace mascot
