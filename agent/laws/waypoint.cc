// PD flight through waypoints, the first experiment of the MASCOT paper (Pandit, Njattuvetty, Mulla):
//   a_i = p_gain (w - p_i) - d_gain v_i
// The target w becomes the next waypoint on arrival or at a given time; the last waypoint stays the target.
#include <map>
#include <memory>
#include <utility>

#include "agent/laws/waypoint_flight.h"

namespace mascot {
namespace {

struct WaypointLawParams final : LawParams {
  WaypointParams flight;
};

class Waypoint final : public Law {
 public:
  explicit Waypoint(WaypointFlight flight) : flight_(std::move(flight)) {}

  void Adopt(const AgentConfig& agent) override { flight_.Adopt(ParamsOf<WaypointLawParams>(agent.law).flight); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    return flight_.Accel_W(t_s, self);
  }

 private:
  WaypointFlight flight_;
};

std::shared_ptr<const LawParams> ReadWaypoint(const Experiment& /*experiment*/, const LawConfig& law,
                                              Section& section) {
  if (law.leader != 0)
    section.Fail("leader", "expected 0 (every agent flies the waypoints itself), got " + std::to_string(law.leader));
  auto params = std::make_shared<WaypointLawParams>();
  params->flight = ReadWaypoints(section, "");
  return params;
}

std::unique_ptr<Law> MakeWaypoint(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  return std::make_unique<Waypoint>(
      WaypointFlight(ParamsOf<WaypointLawParams>(agent.law).flight, agent.law.axes, agent.p_W));
}

std::map<std::string, Value> GoToOfWaypoint(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s) {
  return Destination("", &ParamsOf<WaypointLawParams>(agent.law).flight, p_W, t_s);
}

std::span<const Eigen::Vector3d> WaypointsOfWaypoint(const LawConfig& law) {
  return ParamsOf<WaypointLawParams>(law).flight.waypoints_W;
}

LinearForm LinearWaypoint(const LawConfig& law) {
  const WaypointParams& flight = ParamsOf<WaypointLawParams>(law).flight;
  return {.p = flight.p_gain, .beta = flight.d_gain, .listens = false, .leader_flies = true};
}

}  // namespace

LawEntry WaypointLaw() {
  static constexpr std::string_view kErrorPicture[] = {"error"};
  return {.name = "waypoint",
          .summary = "every agent flies the same list of waypoints, by arrival or by time",
          .equation = "a_i = p_gain (w - p_i) - d_gain v_i",
          .theory = "modes s^2 + d_gain s + p_gain; no overshoot from rest for d_gain >= 2 sqrt(p_gain) without limits",
          .source = "Pandit, Njattuvetty, Mulla: MASCOT",
          .parameters = kWaypointParameters,
          .axes = Axes::kXyz,
          .gathers = true,
          .drawing = {.pictures = kErrorPicture},
          .read = ReadWaypoint,
          .make = MakeWaypoint,
          .go_to = GoToOfWaypoint,
          .waypoints_W = WaypointsOfWaypoint,
          .linear = LinearWaypoint};
}

}  // namespace mascot
