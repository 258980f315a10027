#pragma once

#include <Eigen/Core>
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

inline constexpr LawParameter kWaypointParameters[] = {
    {"waypoints_m", "*", "[[x, y, z], ...], m", "targets, flown in this order by every agent; the last one is held"},
    {"p_gain", "1.0", "[0, 1000], 1/s^2", "pull towards the target"},
    {"d_gain", "1.0", "[0, 1000], 1/s", "damping"},
    {"arrival_radius_m", "0.2", "(0, 1000], m", "a target counts as reached this close to it, over law.axes"},
    {"dwell_s", "1.0", "[0, 1e6], s", "time to stay that close before the next target"},
    {"times_s", "", "increasing, >= 0, s", "when each waypoint becomes the target, instead of by arrival"},
};

/// Reads the keys above, each with `prefix` before its name.
WaypointParams ReadWaypoints(Section& law, const std::string& prefix);
/// Reads `leader_waypoints_m` and its companions; none: the leader has no waypoints. Refuses them where
/// there is no leader.
std::optional<WaypointParams> ReadLeaderWaypoints(LawConfig& law);

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
