#include "agent/laws/parts/waypoint_flight.h"

#include <algorithm>
#include <utility>

namespace mascot {
namespace {

// Tolerance for rounding: times are ticks divided by the rate.
constexpr double kRounding_s = 1e-9;

/// Notes a mistake if there are times, but not as many as targets. `whose`: " of agent 2".
void CheckCount(Section& law, const std::string& key, const WaypointParams& params, const std::string& whose) {
  if (!law.Has(key) || law.Wrong(key) || params.times_s.size() == params.waypoints_W.size()) return;
  law.Fail(key, "expected " + std::to_string(params.waypoints_W.size()) + " times, one per waypoint" + whose +
                    ", got " + std::to_string(params.times_s.size()));
}

void CheckOrder(Section& law, const std::string& key, const std::vector<double>& times_s) {
  if (law.Wrong(key)) return;
  for (std::size_t n = 1; n < times_s.size(); ++n) {
    if (times_s[n] <= times_s[n - 1]) {
      law.FailRow(key, n,
                  "expected a time after " + ShortestFloat(times_s[n - 1]) + ", got " + ShortestFloat(times_s[n]));
    }
  }
}

/// Reads the keys but waypoints_m.
WaypointParams ReadFlight(Section& law, const std::string& prefix) {
  const auto key = [&prefix](const char* name) { return prefix + name; };
  law.Supersede(key("times_s"), {key("arrival_radius_m"), key("dwell_s")});
  for (const char* name : {"arrival_radius_m", "dwell_s"}) law.Supersede(key(name), {key("times_s")});
  WaypointParams params;
  params.p_gain = law.Number(key("p_gain"));
  params.d_gain = law.Number(key("d_gain"));
  if (law.Has(key("times_s"))) {
    params.times_s = law.Numbers(key("times_s"));
    CheckOrder(law, key("times_s"), params.times_s);
    for (const char* name : {"arrival_radius_m", "dwell_s"}) {
      if (law.Has(key(name)))
        law.Fail(key(name), "expected only one of " + key("times_s") + " and " + key(name) + ", got both");
    }
  } else {
    params.arrival_radius_m = law.Number(key("arrival_radius_m"));
    params.dwell_s = law.Number(key("dwell_s"));
  }
  return params;
}

}  // namespace

WaypointParams ReadWaypoints(Section& law, const std::string& prefix) {
  const std::string key = prefix + "waypoints_m";
  std::vector<Eigen::Vector3d> waypoints_W = law.Points(key);
  if (waypoints_W.empty() && !law.Wrong(key)) law.Fail(key, "expected a list of points [x, y, z], got nothing");
  WaypointParams params = ReadFlight(law, prefix);
  params.waypoints_W = std::move(waypoints_W);
  CheckCount(law, prefix + "times_s", params, "");
  return params;
}

std::map<int, WaypointParams> ReadWaypointsOfAgents(Section& law, std::span<const AgentConfig> agents) {
  if (law.Has("waypoints_m")) return {{0, ReadWaypoints(law, "")}};
  if (std::ranges::all_of(agents, [](const AgentConfig& agent) { return agent.waypoints_W.empty(); }))
    law.Fail("waypoints_m", "expected targets of all agents here, or of each in agents.waypoints_m, got none");
  std::map<int, WaypointParams> flights{{0, ReadFlight(law, "")}};
  for (const AgentConfig& agent : agents) {
    if (agent.waypoints_W.empty()) continue;
    WaypointParams& flight = flights[agent.id] = flights[0];
    flight.waypoints_W = agent.waypoints_W;
    CheckCount(law, "times_s", flight, " of agent " + std::to_string(agent.id));
  }
  return flights;
}

std::optional<WaypointParams> ReadLeaderWaypoints(const LawConfig& config, Section& law) {
  const bool has_waypoints = law.Has("leader_waypoints_m");
  if (config.leader > 0 && has_waypoints) return ReadWaypoints(law, "leader_");
  for (const Key& parameter : kLeaderFlightParameters) {
    if (!law.Has(parameter.name) || law.Wrong("leader")) continue;
    law.Fail(parameter.name, config.leader == 0
                                 ? "expected law.leader to name the agent that this is for, got no leader"
                                 : "expected leader_waypoints_m beside it, got none");
  }
  return std::nullopt;
}

WaypointFlight::WaypointFlight(WaypointParams params, Axes axes, const std::optional<Eigen::Vector3d>& start_W)
    : params_(std::move(params)), axes_(axes), start_W_(start_W) {}

void WaypointFlight::Adopt(const WaypointParams& params) {
  if (params.waypoints_W != params_.waypoints_W) {
    next_ = 0;
    arrived_at_s_.reset();
  }
  params_ = params;
}

std::optional<Eigen::Vector3d> KnownStart(const AgentConfig& agent) {
  return agent.law.since == 0 ? std::optional(agent.p_W) : std::nullopt;
}

void FlyAs(const std::optional<WaypointParams>& params, const AgentConfig& agent,
           std::optional<WaypointFlight>& flight) {
  if (!params)
    flight.reset();
  else if (flight)
    flight->Adopt(*params);
  else
    flight.emplace(*params, agent.law.axes, KnownStart(agent));
}

std::map<std::string, Value> Destination(const std::string& prefix, const WaypointParams* now,
                                         const Eigen::Vector3d& p_W, double t_s) {
  std::map<std::string, Value> keys;
  keys[prefix + "waypoints_m"] = {Value::List{{Value::List{{p_W.x()}, {p_W.y()}, {p_W.z()}}}}};
  if (now != nullptr && !now->times_s.empty()) keys[prefix + "times_s"] = {Value::List{{t_s}}};
  return keys;
}

Eigen::Vector3d WaypointFlight::Accel_W(double t_s, const Motion& self) {
  if (params_.waypoints_W.empty()) return Eigen::Vector3d::Zero();
  const std::optional<std::size_t> target = Target(t_s, self.p_WB);
  if (!start_W_) start_W_ = self.p_WB;
  const Eigen::Vector3d& target_W = target ? params_.waypoints_W[*target] : *start_W_;
  return params_.p_gain * (target_W - self.p_WB) - params_.d_gain * self.v_WB;
}

std::optional<std::size_t> WaypointFlight::Target(double t_s, const Eigen::Vector3d& p_WB) {
  return params_.times_s.empty() ? TargetByArrival(t_s, p_WB) : TargetByTime(t_s);
}

std::optional<std::size_t> WaypointFlight::TargetByTime(double t_s) const {
  std::size_t begun = 0;
  while (begun < params_.times_s.size() && t_s >= params_.times_s[begun]) ++begun;
  return begun == 0 ? std::nullopt : std::optional(begun - 1);
}

std::size_t WaypointFlight::TargetByArrival(double t_s, const Eigen::Vector3d& p_WB) {
  while (next_ + 1 < params_.waypoints_W.size()) {
    if (Distance(p_WB) > params_.arrival_radius_m) {
      arrived_at_s_.reset();
      break;
    }
    if (!arrived_at_s_) arrived_at_s_ = t_s;
    if (t_s - *arrived_at_s_ < params_.dwell_s - kRounding_s) break;
    arrived_at_s_.reset();
    ++next_;
  }
  return next_;
}

double WaypointFlight::Distance(const Eigen::Vector3d& p_WB) const {
  const Eigen::Vector3d to_target = params_.waypoints_W[next_] - p_WB;
  return axes_ == Axes::kXyz ? to_target.norm() : to_target.head<2>().norm();
}

}  // namespace mascot
