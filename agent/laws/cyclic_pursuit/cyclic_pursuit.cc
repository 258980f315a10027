// Cyclic pursuit: agent i flies after agent i + 1, agent N after agent 1, each turned by alpha to the right of it;
// Pavone & Frazzoli (2007):
//   v_i = gain R(alpha) (p_{i+1} - p_i),  R(alpha) = [cos alpha, sin alpha; -sin alpha, cos alpha] in x and y
// The centre stays. A regular N-gon stays regular: its radius grows at the rate gain (cos(2 pi/N - alpha) - cos alpha),
// its agents go round at the rate gain (sin(2 pi/N - alpha) + sin alpha) to the left. From almost any start agents
// meet (|alpha| < pi/N), circle at 2 gain sin(pi/N) (alpha = pi/N), or spiral out. Theory has the sampled motion.
// Unicycles steer by themselves, as Marshall, Broucke & Francis (2004, 2006) have it: unicycle_pursuit.h.
#include "agent/laws/cyclic_pursuit/cyclic_pursuit.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "agent/laws/cyclic_pursuit/cyclic_modes.h"
#include "agent/laws/cyclic_pursuit/ring_meter.h"
#include "agent/laws/parts/agreement.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/rounding.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr Key kCyclicPursuitParameters[] = {
    key::OneOf("pursuit", kPursuits.names(),
               "linear: straight, by velocities; for unicycles also by their own speed, which is speed_m_per_s or gain "
               "times the distance, and by turning at turn_gain times the angle")
        .Default("\"linear\""),
    key::Number("gain", {0, 1000}, "speed at 1 m from the next agent; weights of the graph do not count")
        .Default("1.0")
        .Unit("1/s")
        .Live(),
    key::Number("alpha_deg", {-180, 180}, "turn to the right of the way to the next agent; 180 / N: a circle")
        .Default("0.0")
        .Live(),
    key::Number("speed_m_per_s", Above(0, 1000), "of unicycles with a constant speed").Default("0.5").Live(),
    key::Number("turn_gain", Above(0, 1000), "turning speed per angle from the heading to the next agent")
        .Default("1.0")
        .Unit("1/s")
        .Live(),
};

constexpr double kMaxRounded = 1e-3;  // share of a turn that may be rounding, beyond 1e-6 rad/s

int NextOf(int id, int agents) { return id == agents ? 1 : id + 1; }

/// Notes a mistake if agents that are to steer are no unicycles, or to turn aside.
void CheckSteered(const Experiment& experiment, const LawConfig& law, Section& section) {
  const std::string pursuit(section.OneOf("pursuit"));
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.law.name != law.name || agent.traits().rolls) continue;
    section.Fail("pursuit",
                 fmt::format("expected unicycles for \"{}\", got agent {}, a {}", pursuit, agent.id, agent.model));
    break;
  }
  if (const double alpha_deg = section.Number("alpha_deg"); alpha_deg != 0)
    section.Fail("alpha_deg",
                 fmt::format("expected 0 with law.pursuit = \"{}\", got {}", pursuit, ShortestFloat(alpha_deg)));
}

std::shared_ptr<const LawParams> ReadCyclicPursuit(const Experiment& experiment, const LawConfig& law,
                                                   Section& section) {
  auto params = std::make_shared<CyclicPursuitParams>();
  ExpectNoLeader(law, section);
  params->pursuit = kPursuits.Value(section.OneOf("pursuit"));
  params->gain = section.Number("gain");
  params->alpha_rad = section.Number("alpha_deg") * std::numbers::pi / 180;
  params->steered = {.turn_gain = section.Number("turn_gain"), .speed_m_per_s = section.Number("speed_m_per_s")};
  if (params->pursuit == PursuitKind::kProportionalSpeed) params->steered.speed_gain = params->gain;
  if (params->pursuit != PursuitKind::kLinear) CheckSteered(experiment, law, section);
  for (int id = 1; id <= experiment.graph.size() && !section.Wrong("name"); ++id) {
    const int next = NextOf(id, experiment.graph.size());
    if (!experiment.graph.Hears(id, next))
      section.Fail("name", fmt::format("expected a graph in which agent {} hears the next one, {}, got one without "
                                       "the edge [{}, {}]",
                                       id, next, id, next));
  }
  return params;
}

std::unique_ptr<Law> MakeCyclicPursuit(const Experiment& experiment, int id) {
  return std::make_unique<CyclicPursuit>(experiment.agent(id), NextOf(id, experiment.size()));
}

LawTheory PredictCyclicPursuit(const Experiment& experiment) {
  const auto& params = ParamsOf<CyclicPursuitParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  std::vector<Eigen::Vector2d> starts;
  for (const AgentConfig& agent : experiment.agents) starts.emplace_back(agent.p_W.head<2>());
  const double start_m = RingMotionOf(starts, starts, 1).radius_m;
  const CyclicModes modes(starts, experiment.period_s() * params.gain, params.alpha_rad);
  const auto [radius_m, turn_rate_rad_per_s] = modes.At(experiment.ticks(), experiment.period_s());
  if (!std::isfinite(radius_m) || start_m < kRoundedRadius_m)
    return {.silent = "the radius is no finite multiple of that at the start"};
  // Agents turn by the angle between two places, which rounding moves by `off_m` at the most.
  const double off_m = RoundingShare(experiment) * SizeOfStart_m(experiment);
  PredictedFigure turn_rate{.values = {turn_rate_rad_per_s},
                            .magnitude = SizeOfStart_m(experiment) / radius_m / experiment.period_s()};
  if (off_m / (radius_m * experiment.period_s()) > 1e-6 + kMaxRounded * std::abs(turn_rate_rad_per_s))
    turn_rate = NotPredicted("agents are together by the end, and rounding decides where each of them is");
  LawTheory theory{.figures = {{.values = {radius_m}},
                               {.values = {radius_m / start_m}, .magnitude = SizeOfStart_m(experiment) / start_m},
                               std::move(turn_rate)},
                   .unlimited = true};
  if (modes.Meet()) theory.value_m = MeanStart(experiment);
  return theory;
}

}  // namespace

LawEntry CyclicPursuitLaw() {
  return {
      .name = "cyclic_pursuit",
      .summary = "each agent flies after the next one of a ring: to a point, on a circle, on spirals",
      .equation =
          "linear: v_i = gain R(alpha) (p_{i+1} - p_i), R(alpha) a turn to the right in x and y;  unicycles: at "
          "speed_m_per_s, or gain |p_{i+1} - p_i|, and turning by turn_gain times the angle to the next",
      .tex =
          R"(\text{linear: } v_i = k\, R(\alpha) (p_{i+1} - p_i), \quad R(\alpha) = \begin{pmatrix} \cos\alpha & \sin\alpha \cr -\sin\alpha & \cos\alpha \end{pmatrix} \\
\text{unicycles: speed } s \text{ or } k\, \lvert p_{i+1} - p_i \rvert, \text{ turning by } k_\omega \text{ times the angle to the next})",
      .symbols = {{"gain", "k"}, {"alpha_deg", R"(\alpha)"}, {"speed_m_per_s", "s"}, {"turn_gain", R"(k_\omega)"}},
      .graph = "a directed ring: agent i hears agent i + 1, and the last one the first",
      .details =
          "Weights of the graph do not count, and neither does any agent but the next one; while it is not heard, i "
          "wants the velocity 0.\n"
          "pursuit = \"linear\": R(alpha) = [cos alpha, sin alpha; -sin alpha, cos alpha], alpha = alpha_deg; z is "
          "pulled by gain alone. It is the law of bodies without a heading: unicycles that fly by it follow with the "
          "point control.look_ahead_m ahead of them.\n"
          "pursuit = \"constant_speed\" and \"proportional_speed\": v = speed_m_per_s, or gain r, and w = turn_gain "
          "a, r the distance to the next and a, in (-pi, pi], the angle to the left from the heading to it.",
      .theory =
          "the centre stays; |alpha| < pi/N: agents meet; alpha = pi/N: they circle at 2 gain sin(pi/N); beyond: "
          "spirals that open; a regular N-gon stays regular, its radius grows at the rate gain (cos(2 pi/N - "
          "alpha) - cos alpha); unicycles near a circle of one turn: to the radius N speed / (pi turn_gain) at "
          "constant speed, else they close in for turn_gain > 2 N gain sin(pi/N) / pi, and part below",
      .source =
          "Marshall, Broucke & Francis, Formations of vehicles in cyclic pursuit, IEEE Trans. Autom. Control 49 "
          "(2004), and Pursuit formations of unicycles, Automatica 42 (2006); Pavone & Frazzoli, Decentralized "
          "policies for geometric pattern formation and path coverage, J. "
          "Dyn. Syst. Meas. Control 129 (2007)",
      .parameters = kCyclicPursuitParameters,
      .figures = kRingFigures,
      .curve =
          LawCurve{
              .name = "radius", .unit = "m", .meaning = "rms distance from the centre in x and y", .decays = false},
      .drawing = {},
      .read = ReadCyclicPursuit,
      .make = MakeCyclicPursuit,
      .wanted = WantsVelocity,
      .predict = PredictCyclicPursuit,
      .meter = MeterOf<RingMeter>};
}

}  // namespace mascot
