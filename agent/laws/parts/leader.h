#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "agent/laws/parts/waypoint_flight.h"
#include "experiment/experiment.h"

namespace mascot {

/// How the leader of a law flies; nullopt: its acceleration is 0.
using LeaderFlight = const std::optional<WaypointParams>&(const LawConfig& law);
/// Makes the law of a leader, which does not use what it hears: it keeps its velocity (a = 0), or flies waypoints.
std::unique_ptr<Law> MakeLeader(LeaderFlight* flight_of, const AgentConfig& agent);
/// The parameters that make such a leader fly to `p_W`, as LawEntry::go_to gives them.
std::map<std::string, Value> GoToOfLeader(LeaderFlight* flight_of, const AgentConfig& agent, const Eigen::Vector3d& p_W,
                                          double t_s);

/// LawEntry::go_to and LawEntry::waypoints_W for laws with such a leader.
template <LeaderFlight* flight_of>
std::map<std::string, Value> GoToOf(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s) {
  return GoToOfLeader(flight_of, agent, p_W, t_s);
}
template <LeaderFlight* flight_of>
std::span<const Eigen::Vector3d> LeaderWaypointsOf(const AgentConfig& leader) {
  return WaypointsOf(flight_of(leader.law));
}

}  // namespace mascot
