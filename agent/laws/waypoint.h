#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws.h"
#include "experiment/experiment.h"

namespace mascot {

/// A list of waypoints, when each of them is the target, and how firmly it pulls.
struct WaypointParams {
  std::vector<Eigen::Vector3d> waypoints_W;  ///< never empty in a valid experiment
  std::vector<double> times_s;               ///< when each becomes the target; empty: by arrival
  double arrival_radius_m = 0;
  double dwell_s = 0;
  double p_gain = 0;
  double d_gain = 0;
};

inline constexpr Range kWaypoint_m = {-1e6, 1e6};
inline constexpr Range kGain = {0, 1000};
inline constexpr Range kTime_s = {0, 1e6};

inline constexpr Key kWaypointParameters[] = {
    key::Points("waypoints_m", kWaypoint_m, "targets, flown in this order by every agent; the last one is held")
        .Required(),
    key::Number("p_gain", kGain, "pull towards the target").Default("1.0").Unit("1/s^2"),
    key::Number("d_gain", kGain, "damping").Default("1.0").Unit("1/s"),
    key::Number("arrival_radius_m", Above(0, 1000), "a target counts as reached this close to it, over law.axes")
        .Default("0.2"),
    key::Number("dwell_s", kTime_s, "time to stay that close before the next target").Default("1.0"),
    key::Numbers("times_s", kTime_s, "when each waypoint becomes the target, instead of by arrival; increasing"),
};

/// The same for a leader, of the laws that may have one.
inline constexpr std::array kLeaderFlightParameters = {
    key::Points("leader_waypoints_m", kWaypoint_m, "the leader flies these, as the waypoint law does"),
    key::Number("leader_p_gain", kGain, "with leader_waypoints_m, as the waypoint law's p_gain")
        .Default("1.0")
        .Unit("1/s^2"),
    key::Number("leader_d_gain", kGain, "likewise d_gain").Default("1.0").Unit("1/s"),
    key::Number("leader_arrival_radius_m", Above(0, 1000), "likewise arrival_radius_m").Default("0.2"),
    key::Number("leader_dwell_s", kTime_s, "likewise dwell_s").Default("1.0"),
    key::Numbers("leader_times_s", kTime_s, "likewise times_s"),
};

/// Reads the keys of either table above, `prefix` being what stands before their names.
WaypointParams ReadWaypoints(Section& law, const std::string& prefix);
/// Reads `leader_waypoints_m` and its companions; none: the leader has no waypoints. Refuses them where
/// there is no leader.
std::optional<WaypointParams> ReadLeaderWaypoints(const LawConfig& law, Section& section);

/// Flies one agent through a list of waypoints: a = p_gain (w - p) - d_gain v.
class WaypointFlight {
 public:
  /// `start_W` is the target until the first of `times_s`.
  WaypointFlight(WaypointParams params, Axes axes, const Eigen::Vector3d& start_W);
  Eigen::Vector3d Accel_W(double t_s, const Motion& self);

 private:
  const Eigen::Vector3d& TargetByTime(double t_s);
  const Eigen::Vector3d& TargetByArrival(double t_s, const Eigen::Vector3d& p_WB);
  double Distance(const Eigen::Vector3d& p_WB) const;

  WaypointParams params_;
  Axes axes_;
  Eigen::Vector3d start_W_;
  std::size_t next_ = 0;                  // by arrival: index of the target
  std::optional<double> arrived_at_s_{};  // since when the agent has been close to it
};

}  // namespace mascot
