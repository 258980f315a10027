// The law platoon, Ploeg et al. (2011, 2014): its keys and its row. platoon_driver.cc has the equations,
// platoon_theory.cc what is predicted and measured.
#include "agent/laws/platoon/platoon.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr EnumNames<int, 2> kDirections({{1, "east"}, {-1, "west"}});

constexpr Key kPlatoonParameters[] = {
    key::OneOf("direction", kDirections.names(), "where the platoon drives, along x").Default("\"east\""),
    key::Number("spacing_m", Above(0, 1e4), "wanted distance between neighbours at rest").Default("3.0").Live(),
    key::Number("headway_s", {0, 100}, "wanted distance grows by this much per speed").Default("0.6").Live(),
    key::Number("p_gain", Above(0, 1000), "pull towards the wanted distance").Default("2.0").Unit("1/s^2").Live(),
    key::Number("d_gain", {0, 1000}, "pull against a change of the error of the distance")
        .Default("1.5")
        .Unit("1/s")
        .Live(),
    key::Number("dd_gain", {0, 1000}, "pull against a change of that change").Default("0.0").Live(),
    key::Boolean("feed_forward", "whether each hears by message what its predecessor tells its vehicle, u")
        .Default("true"),
    key::Number("message_delay_s", {0, 2}, "how old that is; whole ticks, at least the one that a message takes")
        .Default("0.0"),
    key::Number("actuator_lag_s", {0, 10},
                "of the acceleration of a vehicle behind what it is told; 0: none but the body's own")
        .Default("0.1"),
    key::Number("actuator_delay_s", {0, 2}, "after which a vehicle begins to do what it is told; whole ticks")
        .Default("0.0"),
    key::Number("speed_m_per_s", {0, 1000}, "of agent 1, on average").Default("5.0").Live(),
    key::Number("disturbance_m_per_s", {0, 1000}, "by how much the speed of agent 1 swings about that").Default("0.5"),
    key::Number("disturbance_period_s", Above(0, 1e6), "of that swing").Default("10.0"),
};

constexpr LawFigure kPlatoonFigures[] = {
    {.name = "amplification",
     .meaning = "swing of the speed by that of the predecessor, at the frequency of the disturbance, in the long run: "
                "none while it still changes by more than 1 %",
     .each = "follower"},
    {.name = "string_gain", .meaning = "the largest of these; in theory, at any frequency: a stable string has 1"},
    {.name = "least_gap_m",
     .meaning = "the smallest distance to a predecessor, along the way they drive; negative: it was overtaken"},
    {.name = "least_headway_s",
     .meaning = "in theory alone: the smallest headway from which on no swing grows from vehicle to vehicle"},
};

Following ReadFollowing(const Experiment& experiment, Section& section) {
  Following following{.h = experiment.period_s()};
  const auto ticks = [&](const char* key) { return static_cast<int>(std::lround(section.Number(key) / following.h)); };
  following.headway_s = section.Number("headway_s");
  following.p = section.Number("p_gain");
  following.d = section.Number("d_gain");
  following.dd = section.Number("dd_gain");
  following.feed_forward = section.Boolean("feed_forward");
  following.message_ticks = std::max(1, ticks("message_delay_s"));
  following.lag_s = section.Number("actuator_lag_s");
  following.delay_ticks = ticks("actuator_delay_s");
  return following;
}

std::shared_ptr<const LawParams> ReadPlatoon(const Experiment& experiment, const LawConfig& law, Section& section) {
  ExpectNoLeader(law, section);
  auto params = std::make_shared<PlatoonParams>();
  params->forward = kDirections.Value(section.OneOf("direction"));
  params->spacing_m = section.Number("spacing_m");
  params->following = ReadFollowing(experiment, section);
  params->sends_messages = params->following.feed_forward;
  params->speed = section.Number("speed_m_per_s");
  params->swing = section.Number("disturbance_m_per_s");
  params->w = 2 * std::numbers::pi / section.Number("disturbance_period_s");
  for (int id = 2; id <= experiment.size() && experiment.graph.size() == experiment.size(); ++id) {
    const auto& heard = experiment.graph.HeardBy(id);
    if (std::ranges::find(heard, id - 1, &Graph::Neighbour::id) != heard.end()) continue;
    section.Fail(
        "", fmt::format("expected each agent to hear the one before it, got a graph in which {} does not hear {}", id,
                        id - 1));
    break;
  }
  return params;
}

}  // namespace

LawEntry PlatoonLaw() {
  return {
      .name = "platoon",
      .summary = "vehicles follow their predecessors along x, at a distance that grows with the speed",
      .equation =
          "headway u_i' = -u_i + p_gain e_i + d_gain e_i' + dd_gain e_i'' + u_{i-1}(t - theta), e_i = x_{i-1} - x_i - "
          "spacing - headway v_i;  tau a_i' = -a_i + u_i(t - phi);  agent 1: u_1 = v_r' + tau v_r'' + d_gain (v_r - "
          "v_1)",
      .tex =
          R"(h_w \dot u_i = -u_i + k_p e_i + k_d \dot e_i + k_{dd} \ddot e_i + u_{i-1}(t - \theta), \quad e_i = x_{i-1} - x_i - r - h_w v_i \\
\tau \dot a_i = -a_i + u_i(t - \varphi) \\
\text{agent 1: } u_1 = \dot v_r + \tau \ddot v_r + k_d (v_r - v_1))",
      .symbols = {{"headway_s", "h_w"},
                  {"p_gain", "k_p"},
                  {"d_gain", "k_d"},
                  {"dd_gain", "k_{dd}"},
                  {"spacing_m", "r"},
                  {"message_delay_s", R"(\theta)"},
                  {"actuator_lag_s", R"(\tau)"},
                  {"actuator_delay_s", R"(\varphi)"}},
      .graph = "a directed path: agent i hears agent i - 1",
      .details =
          "Sampled: what a controller knows is held for a tick, of which u goes the share 1 - exp(-h / headway) to "
          "where "
          "it would end (all of it for headway = 0). e_i' is v_{i-1} - v_i - headway times the mean acceleration of "
          "the "
          "tick before; e_i'' is the backward difference of e_i', and 0 at first. theta is message_delay_s, a whole "
          "number of ticks, and one at least.\n"
          "Bodies have no lag tau and no delay phi: the law has them, and what it commands is the mean of the "
          "vehicle's "
          "acceleration over the tick. Agents keep to their line by a = p_gain (y_{i-1} - y_i) + d_gain (v_{i-1} - "
          "v_i) "
          "across, agent 1 by -d_gain v. The v_r' and v_r'' of agent 1 are those of the middle of the tick in which "
          "its "
          "vehicle does what it is told. While i does not hear i - 1 at a tick, its u decays to 0 with the time "
          "constant "
          "headway.\n"
          "direction = \"west\" turns the sign of x.",
      .theory =
          "from one vehicle to the next swings grow by Gamma(s) = (1/H) (G K + D) / (1 + G K), H = headway s + 1, G = "
          "exp(-phi s) / (s^2 (tau s + 1)), K = p_gain + d_gain s + dd_gain s^2, D = exp(-theta s), or 0 without "
          "feed_forward: the string is stable iff |Gamma(j omega)| <= 1 for all omega; with p_gain = 0.2, d_gain = "
          "0.7, tau = 0.1, phi = 0 from a headway of 3.16 s on, or of 0.67 s with messages and theta = 0.15",
      .source =
          "Ploeg, Scheepers, van Nunen, van de Wouw & Nijmeijer, Design and experimental evaluation of cooperative "
          "adaptive cruise control, IEEE Conf. Intelligent Transportation Systems 2011; Ploeg, van de Wouw & "
          "Nijmeijer, "
          "Lp string stability of cascaded systems: application to vehicle platooning, IEEE Trans. Control Systems "
          "Technology 22 (2014)",
      .parameters = kPlatoonParameters,
      .figures = kPlatoonFigures,
      .curve = LawCurve{.name = "smallest gap",
                        .unit = "m",
                        .meaning = "between an agent and the one before it",
                        .decays = false,
                        .figure = "least_gap_m"},
      .drawing = {.pictures = {}, .telling = "velocity"},
      .read = ReadPlatoon,
      .make = MakeOf<Platoon>,
      .predict = PredictPlatoon,
      .meter = MakePlatoonMeter};
}

}  // namespace mascot
