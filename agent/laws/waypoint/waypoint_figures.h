#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "agent/laws/law_figures.h"
#include "agent/laws/parts/waypoint_flight.h"

namespace mascot {

/// Measures the flight of one agent through its waypoints.
class WaypointTrack {
 public:
  WaypointTrack(const WaypointParams& params, Axes axes, const Eigen::Vector3d& start_W);
  /// Flies by other parameters from now on. Another list of waypoints begins anew.
  void Adopt(const WaypointParams& params);
  void Add(double t_s, const Eigen::Vector3d& p_W);
  /// From the newest place to the waypoint that is flown to (m); absent: none is.
  std::optional<double> distance_m() const { return distance_m_; }
  /// Since when the agent stays within 2 % of the way to its last waypoint; absent: it does not yet.
  std::optional<double> there_s() const;
  /// The figures of several flights: latest arrival at each waypoint, largest overshoot, latest settling, rms distance.
  static std::vector<FigureValues> FiguresOf(const std::vector<WaypointTrack>& tracks);

 private:
  void Begin(std::size_t target, double t_s, const Eigen::Vector3d& p_W);
  std::optional<double> settling_time_s() const;

  Axes axes_;
  WaypointParams params_;
  WaypointFlight flight_;
  std::optional<std::size_t> target_{};
  double begun_s_ = 0;                               // when it became the target ...
  Eigen::Vector3d way_W_ = Eigen::Vector3d::Zero();  // ... and the way to it from where the agent then was
  std::vector<std::optional<double>> arrivals_s_;    // by waypoint
  std::optional<double> settled_s_{}, distance_m_{};
  double overshoot_m_ = 0, squares_m2_ = 0, ticks_ = 0;
};

/// The flight of an ideal double integrator for `ticks`, whose acceleration is held for a tick; nullopt: the agent's
/// limit would cut what the law asks for.
std::optional<WaypointTrack> IdealTrack(const Experiment& experiment, const AgentConfig& agent,
                                        const WaypointParams& params, std::int64_t ticks);
/// From when on all such agents are at their last waypoints, in the run or long after its end; absent: then neither, or
/// a limit cuts.
std::optional<HoldsFrom> AllThereFrom(const Experiment& experiment,
                                      const WaypointParams& (*flight_of)(const AgentConfig& agent));

}  // namespace mascot
