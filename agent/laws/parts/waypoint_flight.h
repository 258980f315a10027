#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"

namespace mascot {

/// A list of waypoints, what makes each of them the target, and the gains.
struct WaypointParams {
  std::vector<Eigen::Vector3d> waypoints_W;  ///< in W (m); never empty in a valid experiment
  std::vector<double> times_s;               ///< when each becomes the target; empty: on arrival
  double arrival_radius_m = 0;
  double dwell_s = 0;
  double p_gain = 0;  ///< 1/s^2
  double d_gain = 0;  ///< 1/s
};

inline constexpr Range kWaypoint_m = {-1e6, 1e6};
inline constexpr Range kGain = {0, 1000};
inline constexpr Range kTime_s = {0, 1e6};

inline constexpr Key kWaypointParameters[] = {
    key::Points("waypoints_m", kWaypoint_m, "targets, flown in this order by every agent; the last one is held")
        .Otherwise("those of `agents.waypoints_m`; one of the two is required")
        .Live(),
    key::Number("p_gain", kGain, "pull towards the target").Default("1.0").Unit("1/s^2").Live(),
    key::Number("d_gain", kGain, "damping").Default("1.0").Unit("1/s").Live(),
    key::Number("arrival_radius_m", Above(0, 1000), "a target counts as reached this close to it, over law.axes")
        .Default("0.2")
        .Live(),
    key::Number("dwell_s", kTime_s, "time to stay that close before the next target").Default("1.0").Live(),
    key::Numbers("times_s", kTime_s, "when each waypoint becomes the target, instead of by arrival; increasing"),
};

/// The same keys for the leader, in laws that may have one.
inline constexpr std::array kLeaderFlightParameters = {
    key::Points("leader_waypoints_m", kWaypoint_m, "the leader flies these, as the waypoint law does").Live(),
    key::Number("leader_p_gain", kGain, "with leader_waypoints_m, as the waypoint law's p_gain")
        .Default("1.0")
        .Unit("1/s^2")
        .Live(),
    key::Number("leader_d_gain", kGain, "with leader_waypoints_m, as the waypoint law's d_gain")
        .Default("1.0")
        .Unit("1/s")
        .Live(),
    key::Number("leader_arrival_radius_m", Above(0, 1000),
                "with leader_waypoints_m, as the waypoint law's arrival_radius_m")
        .Default("0.2")
        .Live(),
    key::Number("leader_dwell_s", kTime_s, "with leader_waypoints_m, as the waypoint law's dwell_s")
        .Default("1.0")
        .Live(),
    key::Numbers("leader_times_s", kTime_s, "with leader_waypoints_m, as the waypoint law's times_s"),
};

/// Reads the keys of one of the tables above, whose names begin with `prefix`. Mistakes are noted in `law`.
WaypointParams ReadWaypoints(Section& law, const std::string& prefix);
/// Reads the keys of kWaypointParameters, for each agent that has targets of its own, by its id, and, under 0, for the
/// others. If the table has targets, they are those of all.
std::map<int, WaypointParams> ReadWaypointsOfAgents(Section& law, std::span<const AgentConfig> agents);
/// Reads the keys of kLeaderFlightParameters; nullopt: the leader has no waypoints. Notes a mistake where such a key
/// stands without a leader, or without leader_waypoints_m.
std::optional<WaypointParams> ReadLeaderWaypoints(const LawConfig& law, Section& section);

/// The keys, whose names begin with `prefix`, that make an agent fly to `p_W` from `t_s` on, in place of the waypoints
/// that it flies by `now` (null: none).
std::map<std::string, Value> Destination(const std::string& prefix, const WaypointParams* now,
                                         const Eigen::Vector3d& p_W, double t_s);

/// The targets of a flight that there may be.
inline std::span<const Eigen::Vector3d> WaypointsOf(const std::optional<WaypointParams>& flight) {
  return flight ? std::span<const Eigen::Vector3d>(flight->waypoints_W) : std::span<const Eigen::Vector3d>();
}

/// Flies one agent through a list of waypoints: a = p_gain (w - p) - d_gain v, with w the target.
class WaypointFlight {
 public:
  /// `axes`: those that count for arrival. `start_W`: the target until the first of `times_s`; nullopt:
  /// where the agent is at the first Accel_W().
  WaypointFlight(WaypointParams params, Axes axes, const std::optional<Eigen::Vector3d>& start_W);
  /// Flies by other parameters from now on. It keeps its target, unless the list of waypoints is another.
  void Adopt(const WaypointParams& params);
  /// Wanted acceleration in W (m/s^2). `t_s`: simulated time, increasing from call to call.
  Eigen::Vector3d Accel_W(double t_s, const Motion& self);
  /// The index of the target, in Accel_W() or in place of it; nullopt: the start, before the first of times_s.
  std::optional<std::size_t> Target(double t_s, const Eigen::Vector3d& p_WB);

 private:
  std::optional<std::size_t> TargetByTime(double t_s) const;
  std::size_t TargetByArrival(double t_s, const Eigen::Vector3d& p_WB);
  double Distance(const Eigen::Vector3d& p_WB) const;

  WaypointParams params_;
  Axes axes_;
  std::optional<Eigen::Vector3d> start_W_;
  std::size_t next_ = 0;                  // on arrival: index of the target
  std::optional<double> arrived_at_s_{};  // since when the agent has been close to it
};

/// Where the agent is when its law begins, if that is known in advance: at the start of the run.
std::optional<Eigen::Vector3d> KnownStart(const AgentConfig& agent);
/// Makes `flight` of agent `agent` one by `params` (nullopt: none), as an event changes it, or at first.
void FlyAs(const std::optional<WaypointParams>& params, const AgentConfig& agent,
           std::optional<WaypointFlight>& flight);

}  // namespace mascot
