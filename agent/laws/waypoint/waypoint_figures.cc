#include "agent/laws/waypoint/waypoint_figures.h"

#include <algorithm>
#include <cmath>

namespace mascot {
namespace {

constexpr double kSettledShare = 0.02;
constexpr double kArrivedByTime_m = 0.2;  // with times_s, which has no radius of its own

/// Absent if one of them is.
std::optional<double> Later(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::optional(std::max(*a, *b)) : std::nullopt;
}

}  // namespace

WaypointTrack::WaypointTrack(const WaypointParams& params, Axes axes, const Eigen::Vector3d& start_W)
    : axes_(axes), params_(params), flight_(params, axes, start_W), arrivals_s_(params.waypoints_W.size()) {}

void WaypointTrack::Adopt(const WaypointParams& params) {
  if (params.waypoints_W != params_.waypoints_W) {
    target_.reset();
    arrivals_s_.assign(params.waypoints_W.size(), std::nullopt);
  }
  params_ = params;
  flight_.Adopt(params);
}

void WaypointTrack::Begin(std::size_t target, double t_s, const Eigen::Vector3d& p_W) {
  if (params_.times_s.empty())  // with dwell_s = 0 the flight passes on at the tick of its arrival
    for (std::size_t n = 0; n < target; ++n)
      if (!arrivals_s_[n]) arrivals_s_[n] = t_s;
  target_ = target;
  begun_s_ = t_s;
  way_W_ = Along(axes_, params_.waypoints_W[target] - p_W);
  settled_s_.reset();
}

void WaypointTrack::Add(double t_s, const Eigen::Vector3d& p_W) {
  const std::optional<std::size_t> target = flight_.Target(t_s, p_W);
  distance_m_.reset();
  if (!target) return;
  if (target != target_) Begin(*target, t_s, p_W);
  const Eigen::Vector3d to_W = Along(axes_, params_.waypoints_W[*target] - p_W);
  const double distance_m = to_W.norm(), way_m = way_W_.norm();
  distance_m_ = distance_m;
  squares_m2_ += distance_m * distance_m;
  ++ticks_;
  const double radius_m = params_.times_s.empty() ? params_.arrival_radius_m : kArrivedByTime_m;
  if (!arrivals_s_[*target] && distance_m <= radius_m) arrivals_s_[*target] = t_s;
  if (way_m > 0) overshoot_m_ = std::max(overshoot_m_, -to_W.dot(way_W_) / way_m);
  if (distance_m > kSettledShare * way_m)
    settled_s_.reset();
  else if (!settled_s_)
    settled_s_ = t_s - begun_s_;
}

std::optional<double> WaypointTrack::settling_time_s() const {
  const bool is_last = target_ && *target_ + 1 == params_.waypoints_W.size();
  return is_last ? settled_s_ : std::nullopt;
}

std::optional<double> WaypointTrack::there_s() const {
  const std::optional<double> settled_s = settling_time_s();
  return settled_s ? std::optional(begun_s_ + *settled_s) : std::nullopt;
}

std::vector<FigureValues> WaypointTrack::FiguresOf(const std::vector<WaypointTrack>& tracks) {
  FigureValues arrivals_s;
  std::optional<double> settled_s = 0;
  double overshoot_m = 0, squares_m2 = 0, ticks = 0;
  for (const WaypointTrack& track : tracks) {
    if (track.arrivals_s_.size() > arrivals_s.size()) arrivals_s.resize(track.arrivals_s_.size(), 0);
    for (std::size_t n = 0; n < track.arrivals_s_.size(); ++n)
      arrivals_s[n] = Later(arrivals_s[n], track.arrivals_s_[n]);
    settled_s = Later(settled_s, track.settling_time_s());
    overshoot_m = std::max(overshoot_m, track.overshoot_m_);
    squares_m2 += track.squares_m2_;
    ticks += track.ticks_;
  }
  const std::optional<double> rms_m = ticks > 0 ? std::optional(std::sqrt(squares_m2 / ticks)) : std::nullopt;
  return {arrivals_s, {overshoot_m}, {settled_s}, {rms_m}};
}

std::optional<WaypointTrack> IdealTrack(const Experiment& experiment, const AgentConfig& agent,
                                        const WaypointParams& params, std::int64_t ticks) {
  WaypointTrack track(params, agent.law.axes, agent.p_W);
  WaypointFlight flight(params, agent.law.axes, agent.p_W);
  Motion motion{.p_WB = agent.p_W, .v_WB = agent.v_W};
  const double h = experiment.period_s();
  for (std::int64_t tick = 0; tick <= ticks; ++tick) {
    track.Add(experiment.time_s(tick), motion.p_WB);
    const Eigen::Vector3d a_W = Along(agent.law.axes, flight.Accel_W(experiment.time_s(tick), motion));
    if (a_W.cwiseAbs().maxCoeff() > agent.control.max_acceleration_m_per_s2) return std::nullopt;
    motion.p_WB += h * motion.v_WB + h * h / 2 * a_W;
    motion.v_WB += h * a_W;
  }
  return track;
}

namespace {

/// When one agent is there.
std::optional<double> ThereAfter(const Experiment& experiment, const AgentConfig& agent, const WaypointParams& params) {
  constexpr std::int64_t kTimesTheRun = 64, kMaxTicks = 200'000;
  const std::int64_t most = std::max(experiment.ticks(), std::min(kTimesTheRun * experiment.ticks(), kMaxTicks));
  for (std::int64_t ticks = experiment.ticks(); ticks <= most; ticks *= 2) {
    const std::optional<WaypointTrack> track = IdealTrack(experiment, agent, params, ticks);
    if (!track) return std::nullopt;
    if (const auto there_s = track->there_s()) return there_s;
  }
  return std::nullopt;
}

}  // namespace

std::optional<HoldsFrom> AllThereFrom(const Experiment& experiment,
                                      const WaypointParams& (*flight_of)(const AgentConfig& agent)) {
  std::optional<double> there_s = 0;
  for (const AgentConfig& agent : experiment.agents)
    if (there_s) there_s = Later(there_s, ThereAfter(experiment, agent, flight_of(agent)));
  return there_s ? std::optional(HoldsFrom{*there_s}) : std::nullopt;
}

}  // namespace mascot
