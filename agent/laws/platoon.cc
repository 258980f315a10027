// A platoon of vehicles that follow their predecessors; Ploeg, van de Wouw & Nijmeijer (2014). Agent 1 drives a speed
// with a disturbance, v_r = speed + disturbance sin(w t); agent i follows agent i - 1, along x:
//   a_i = p_gain (x_{i-1} - x_i - spacing - headway v_i) + d_gain (v_{i-1} - v_i),   a_1 = v_r' + d_gain (v_r - v_1)
// and keeps to its line, a_y = p_gain (y_{i-1} - y_i) + d_gain (v_y,{i-1} - v_y,i). Each vehicle passes on what its
// predecessor does times Gamma(s) = (d s + p) / (s^2 + (d + p headway) s + p), p and d the gains. The string is stable,
// that is |Gamma(jw)| <= 1 for all w, iff headway >= (sqrt(d^2 + 2 p) - d) / p: never with a constant spacing.
// string_stability.h has the same of the sampled loop, which is what theory uses here.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "agent/laws/ideal.h"
#include "agent/laws/row_parts.h"
#include "agent/laws/string_stability.h"
#include "agent/laws/swing_meter.h"

namespace mascot {
namespace {

constexpr EnumNames<int, 2> kDirections({{1, "east"}, {-1, "west"}});

constexpr Key kPlatoonParameters[] = {
    key::OneOf("direction", kDirections.names(), "where the platoon drives, along x").Default("\"east\""),
    key::Number("spacing_m", Above(0, 1e4), "wanted distance between neighbours at rest").Default("3.0").Live(),
    key::Number("headway_s", {0, 100}, "wanted distance grows by this much per speed").Default("0.6").Live(),
    key::Number("p_gain", Above(0, 1000), "pull towards the wanted distance").Default("2.0").Unit("1/s^2").Live(),
    key::Number("d_gain", {0, 1000}, "pull towards the predecessor's speed").Default("1.5").Unit("1/s").Live(),
    key::Number("speed_m_per_s", {0, 1000}, "of agent 1, on average").Default("5.0").Live(),
    key::Number("disturbance_m_per_s", {0, 1000}, "by how much the speed of agent 1 swings about that").Default("0.5"),
    key::Number("disturbance_period_s", Above(0, 1e6), "of that swing").Default("10.0"),
};

constexpr LawFigure kPlatoonFigures[] = {
    {.name = "amplification",
     .meaning = "swing of the speed by that of the predecessor, at the frequency of the disturbance",
     .each = "follower"},
    {.name = "string_gain", .meaning = "the largest of these; in theory, at any frequency: a stable string has 1"},
    {.name = "least_gap_m", .meaning = "the smallest distance to a predecessor, along x"},
};

struct PlatoonParams final : LawParams {
  double forward = 1;  ///< 1: east, -1: west
  double spacing_m = 0, headway_s = 0, p = 0, d = 0, speed = 0, swing = 0, w = 0;
};

class Platoon final : public Law {
 public:
  Platoon(const AgentConfig& agent, double period_s) : id_(agent.id), half_tick_s_(period_s / 2) { Adopt(agent); }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<PlatoonParams>(agent.law); }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    const PlatoonParams& law = *params_;
    if (id_ == 1) {
      const double v = law.speed + law.swing * std::sin(law.w * t_s);
      const double a = law.swing * law.w * std::cos(law.w * (t_s + half_tick_s_));  // of the middle of the tick
      return {law.forward * a + law.d * (law.forward * v - self.v_WB.x()), -law.d * self.v_WB.y(),
              -law.d * self.v_WB.z()};
    }
    const auto before = std::ranges::find(heard, id_ - 1, &Heard::id);
    if (before == heard.end()) return Eigen::Vector3d::Zero();
    Eigen::Vector3d error_W = before->motion.p_WB - self.p_WB;
    error_W.x() -= law.forward * law.spacing_m + law.headway_s * self.v_WB.x();
    return law.p * error_W + law.d * (before->motion.v_WB - self.v_WB);
  }

 private:
  int id_;
  double half_tick_s_;
  const PlatoonParams* params_ = nullptr;  // the experiment owns them
};

std::shared_ptr<const LawParams> ReadPlatoon(const Experiment& experiment, const LawConfig& law, Section& section) {
  ExpectNoLeader(law, section);
  auto params = std::make_shared<PlatoonParams>();
  params->forward = kDirections.Value(section.OneOf("direction"));
  params->spacing_m = section.Number("spacing_m");
  params->headway_s = section.Number("headway_s");
  params->p = section.Number("p_gain");
  params->d = section.Number("d_gain");
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

LawTheory PredictPlatoon(const Experiment& experiment) {
  const auto& params = ParamsOf<PlatoonParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kAcceleration); !why.empty()) return {.silent = std::move(why)};
  const StringStability string{.p = params.p, .d = params.d, .headway_s = params.headway_s, .h = experiment.period_s()};
  if (string.Loop().Radius() >= 1) return {.silent = "the loop of law.p_gain and law.d_gain does not decay"};
  const int followers = experiment.size() - 1;
  const double most = params.swing * params.w * std::pow(std::max(1.0, string.Gain(params.w)), followers);
  for (const AgentConfig& agent : experiment.agents)
    if (most > agent.control.max_acceleration_m_per_s2)
      return {.silent = "the limit of the acceleration cuts the swing"};
  LawTheory theory{.figures = {{}, {{string.LargestGain()}, Bound::kAtMost}, {}}};
  if (string.LargestGain() > 1)
    theory.warnings.push_back(
        fmt::format("law.headway_s: the string is not stable: swings grow by up to {:.4g} from one "
                    "vehicle to the next; a headway of {:.4g} s would do",
                    string.LargestGain(), string.LeastHeadway_s()));
  const std::optional<std::int64_t> first = SwingMeter::FirstTick(experiment, params.w);
  if (params.swing > 0 && first && string.RestOfStart(static_cast<double>(*first), followers) < 1e-4)
    theory.figures[0].values.assign(static_cast<std::size_t>(followers), string.Gain(params.w));
  return theory;
}

std::unique_ptr<LawMeter> MakePlatoonMeter(const Experiment& experiment, std::span<const int> ids) {
  const auto& params = ParamsOf<PlatoonParams>(experiment.agent(ids.front()).law);
  return std::make_unique<SwingMeter>(experiment, ids, params.w, params.forward * params.speed);
}

}  // namespace

LawEntry PlatoonLaw() {
  return {
      .name = "platoon",
      .summary = "vehicles follow their predecessors along x, at a distance that grows with the speed",
      .equation =
          "a_i = p_gain (x_{i-1} - x_i - spacing - headway v_i) + d_gain (v_{i-1} - v_i);  a_1 = v_r' + d_gain (v_r - "
          "v_1)",
      .theory =
          "swings grow by Gamma(s) = (d s + p) / (s^2 + (d + p headway) s + p) from one vehicle to the next; "
          "|Gamma(jw)| <= 1 for all w iff headway >= (sqrt(d^2 + 2 p) - d) / p",
      .source =
          "Ploeg, van de Wouw & Nijmeijer, Lp string stability of cascaded systems: application to vehicle platooning, "
          "IEEE Trans. Control Systems Technology 22 (2014)",
      .parameters = kPlatoonParameters,
      .figures = kPlatoonFigures,
      .drawing = {.pictures = {}, .telling = "velocity"},
      .read = ReadPlatoon,
      .make = MakeWithPeriod<Platoon>,
      .predict = PredictPlatoon,
      .meter = MakePlatoonMeter};
}

}  // namespace mascot
