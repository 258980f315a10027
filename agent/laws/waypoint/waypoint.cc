// PD flight through waypoints, the first experiment of the MASCOT paper (Pandit, Njattuvetty, Mulla):
//   a_i = p_gain (w - p_i) - d_gain v_i
// The target w becomes the next waypoint on arrival or at a given time; the last waypoint stays the target.
// A double integrator, whose acceleration is held for a tick h, moves by e+ = [1 - h^2 p/2, h - h^2 d/2; -h p, 1 - h d]
// e about each target, e = (p_i - w, v_i), p and d the gains: theory flies the list by this map. From rest and for
// small h it overshoots by exp(-pi z / sqrt(1 - z^2)) of the way, z = d / (2 sqrt(p)).
#include <algorithm>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/parts/waypoint_flight.h"
#include "agent/laws/waypoint/waypoint_figures.h"

namespace mascot {
namespace {

constexpr LawFigure kWaypointFigures[] = {
    {.name = "arrival_time_s",
     .meaning = "when the last agent was first within arrival_radius_m, or 0.2 m with times_s, of its target",
     .each = "waypoint"},
    {.name = "overshoot_m", .meaning = "the farthest that an agent flew past its target, along the way to it"},
    {.name = "settling_time_s",
     .meaning =
         "after which all agents stay within 2 % of the way to the last waypoint, from when it was their target"},
    {.name = "tracking_rms_m", .meaning = "rms distance to the target, of all agents and ticks"},
};

struct WaypointLawParams final : LawParams {
  std::map<int, WaypointParams> flights;  ///< as ReadWaypointsOfAgents() has them
};

const WaypointParams& FlightOf(const AgentConfig& agent) {
  const auto& flights = ParamsOf<WaypointLawParams>(agent.law).flights;
  const auto own = flights.find(agent.id);
  return own != flights.end() ? own->second : flights.at(0);
}

class Waypoint final : public Law {
 public:
  explicit Waypoint(WaypointFlight flight) : flight_(std::move(flight)) {}

  void Adopt(const AgentConfig& agent) override { flight_.Adopt(FlightOf(agent)); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    return flight_.Accel_W(t_s, self);
  }

 private:
  WaypointFlight flight_;
};

std::shared_ptr<const LawParams> ReadWaypoint(const Experiment& experiment, const LawConfig& law, Section& section) {
  if (law.leader != 0)
    section.Fail("leader", "expected 0 (every agent flies the waypoints itself), got " + std::to_string(law.leader));
  auto params = std::make_shared<WaypointLawParams>();
  params->flights = ReadWaypointsOfAgents(section, experiment.agents);
  return params;
}

std::unique_ptr<Law> MakeWaypoint(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  return std::make_unique<Waypoint>(WaypointFlight(FlightOf(agent), agent.law.axes, KnownStart(agent)));
}

std::map<std::string, Value> GoToOfWaypoint(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s) {
  return Destination("", &FlightOf(agent), p_W, t_s);
}

std::span<const Eigen::Vector3d> WaypointsOfWaypoint(const AgentConfig& agent) { return FlightOf(agent).waypoints_W; }

LinearForm LinearWaypoint(const LawConfig& law) {
  const WaypointParams& flight = ParamsOf<WaypointLawParams>(law).flights.at(0);  // the gains are those of all
  return {.p = flight.p_gain, .beta = flight.d_gain, .listens = false, .leader_flies = true};
}

class WaypointMeter final : public LawMeter {
 public:
  WaypointMeter(const Experiment& experiment, std::span<const int> ids)
      : experiment_(&experiment), ids_(ids.begin(), ids.end()) {
    for (const int id : ids) {
      const AgentConfig& agent = experiment.agent(id);
      tracks_.emplace_back(FlightOf(agent), agent.law.axes, agent.p_W);
    }
  }
  void Adopt(const Experiment& now) override {
    experiment_ = &now;
    for (std::size_t i = 0; i < ids_.size(); ++i) tracks_[i].Adopt(FlightOf(now.agent(ids_[i])));
  }
  void Add(const TeamRow& row) override {
    const double t_s = experiment_->time_s(row.tick);
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      const AgentConfig& agent = experiment_->agent(ids_[i]);
      if (t_s < agent.start_s || t_s >= agent.stop_s) continue;
      tracks_[i].Add(t_s, row.motions[static_cast<std::size_t>(agent.id - 1)].p_WB);
    }
  }
  std::vector<FigureValues> Figures() const override { return WaypointTrack::FiguresOf(tracks_); }
  std::optional<double> Curve() const override {
    std::optional<double> farthest_m;
    for (const WaypointTrack& track : tracks_)
      if (const auto own_m = track.distance_m()) farthest_m = std::max(*own_m, farthest_m.value_or(*own_m));
    return farthest_m;
  }

 private:
  const Experiment* experiment_;
  std::vector<int> ids_;
  std::vector<WaypointTrack> tracks_;  // by index in ids_
};

LawTheory PredictWaypoints(const Experiment& experiment) {
  if (std::string why = WhyNotNearlyIdeal(experiment, Wanted::kAcceleration); !why.empty())
    return {.silent = std::move(why)};
  if (std::string why = WhyNotIdeal(experiment, Wanted::kAcceleration); !why.empty()) {
    std::optional<HoldsFrom> holds_from = AllThereFrom(experiment, FlightOf);  // of bodies that do not lag
    if (holds_from) holds_from->bound = Bound::kAtMost;
    return {.silent = std::move(why), .holds_from = std::move(holds_from)};
  }
  std::vector<WaypointTrack> tracks;
  for (const AgentConfig& agent : experiment.agents) {
    const std::optional<WaypointTrack> track = IdealTrack(experiment, agent, FlightOf(agent), experiment.ticks());
    if (!track) return {.silent = "the limit of the acceleration cuts what the law asks for"};
    tracks.push_back(*track);
  }
  LawTheory theory{.figures = Equal(WaypointTrack::FiguresOf(tracks)),
                   .holds_from = AllThereFrom(experiment, FlightOf)};
  for (PredictedFigure& figure : theory.figures)
    if (!std::ranges::all_of(figure.values, [](const auto& value) { return value.has_value(); }))
      figure.why = "the run ends before that";
  return theory;
}

}  // namespace

LawEntry WaypointLaw() {
  static constexpr std::string_view kErrorPicture[] = {"error"};
  return {.name = "waypoint",
          .summary = "every agent flies the same list of waypoints, by arrival or by time",
          .equation = "a_i = p_gain (w - p_i) - d_gain v_i",
          .tex = R"(a_i = k_p (w - p_i) - k_d v_i)",
          .symbols = {{"p_gain", "k_p"}, {"d_gain", "k_d"}},
          .graph = "none: agents do not listen",
          .details =
              "w is the first waypoint. It becomes the next one when the agent has been within arrival_radius_m "
              "of w, along law.axes, for dwell_s without a break; the last one stays.\n"
              "With times_s, w is the latest waypoint whose time has come, and before the first of these times "
              "the agent's start.",
          .theory = "modes s^2 + d_gain s + p_gain; no overshoot from rest for d_gain >= 2 sqrt(p_gain) without limits",
          .source =
              "Pandit, Njattuvetty & Mulla, ROS-based multi-agent systems control simulation testbed (MASCOT), Indian "
              "Control Conference 2022",
          .parameters = kWaypointParameters,
          .figures = kWaypointFigures,
          .curve = LawCurve{.name = "distance to target",
                            .unit = "m",
                            .meaning = "of the agent that is farthest from the waypoint to which it flies"},
          .axes = Axes::kXyz,
          .gathers = true,
          .drawing = {.pictures = kErrorPicture},
          .read = ReadWaypoint,
          .make = MakeWaypoint,
          .go_to = GoToOfWaypoint,
          .waypoints_W = WaypointsOfWaypoint,
          .linear = LinearWaypoint,
          .predict = PredictWaypoints,
          .meter = MeterOf<WaypointMeter>};
}

}  // namespace mascot
