// Pursuit of one evader by single integrators with constant speeds; Isaacs (1965), simple motion; several pursuers:
// Bakolas & Tsiotras (2012):
//   pursuer: v_i = pursuer_speed (p_e - p_i) / |p_e - p_i|           towards the evader, law.leader, if it is heard
//   evader:  v_e = evader_speed (p_e - p_j) / |p_e - p_j|            away from j, the nearest that it hears
// along the axes of the law, and 0 within the capture radius. Each pursuer that hears the evader comes closer by at
// least pursuer_speed - evader_speed, whatever the evader does, also while both hold their velocities for a tick T and
// are farther apart than pursuer_speed T. Hence one captures after at most min_i (|p_e(0) - p_i(0)| - capture_radius) /
// (pursuer_speed - evader_speed), and exactly then if a single pursuer drives it straight away, past no other agent.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/pursuit_evasion/passing.h"

namespace mascot {
namespace {

constexpr Key kPursuitEvasionParameters[] = {
    key::Integer("leader", 1, kMaxAgents, "the evader, 1..N").Required(),
    key::Number("pursuer_speed_m_per_s", Above(0, 1000), "of each pursuer").Default("1.0").Live(),
    key::Number("evader_speed_m_per_s", {0, 1000}, "of the evader").Default("0.6").Live(),
    key::Number("capture_radius_m", Above(0, 1000), "a pursuer this close has captured the evader").Default("0.3"),
};

constexpr LawFigure kPursuitEvasionFigures[] = {
    {.name = "capture_time_s", .meaning = "when the first pursuer was within the capture radius"},
    {.name = "closest_m", .meaning = "the smallest distance of a pursuer to the evader"},
};

struct PursuitEvasionParams final : LawParams {
  double pursuer_speed = 0, evader_speed = 0, radius_m = 0;
};

class PursuitEvasion final : public Law {
 public:
  explicit PursuitEvasion(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { agent_ = &agent; }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const auto& params = ParamsOf<PursuitEvasionParams>(agent_->law);
    const bool flees = agent_->id == agent_->law.leader;
    Eigen::Vector3d way_W = Eigen::Vector3d::Zero();  // to the evader, or to its nearest pursuer
    double distance_m = std::numeric_limits<double>::infinity();
    for (const Heard& j : heard) {
      if (!flees && j.id != agent_->law.leader) continue;
      const Eigen::Vector3d to_W = Along(agent_->law.axes, j.motion.p_WB - self.p_WB);
      if (to_W.norm() >= distance_m) continue;
      way_W = to_W;
      distance_m = to_W.norm();
    }
    if (std::isinf(distance_m) || distance_m <= params.radius_m) return Eigen::Vector3d::Zero();
    return (flees ? -params.evader_speed : params.pursuer_speed) / distance_m * way_W;
  }

 private:
  const AgentConfig* agent_ = nullptr;  // the experiment owns it
};

std::shared_ptr<const LawParams> ReadPursuitEvasion(const Experiment& experiment, const LawConfig& law,
                                                    Section& section) {
  if (law.leader == 0 && !section.Wrong("leader")) section.Fail("leader", "expected the evader in 1..N, got 0");
  if (experiment.size() == 1) section.Fail("", "expected a pursuer beside the evader, got one agent alone");
  auto params = std::make_shared<PursuitEvasionParams>();
  params->pursuer_speed = section.Number("pursuer_speed_m_per_s");
  params->evader_speed = section.Number("evader_speed_m_per_s");
  params->radius_m = section.Number("capture_radius_m");
  return params;
}

LawTheory PredictPursuitEvasion(const Experiment& experiment) {
  const auto& params = ParamsOf<PursuitEvasionParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  if (params.pursuer_speed <= params.evader_speed) return {.silent = "pursuers are not faster than the evader"};
  const double h = experiment.period_s(), closing = params.pursuer_speed - params.evader_speed;
  if (params.radius_m < params.pursuer_speed * h) return {.silent = "a pursuer may fly past the evader within a tick"};
  const AgentConfig& evader = experiment.agent(experiment.law.leader);
  double nearest_m = std::numeric_limits<double>::infinity();
  std::vector<const AgentConfig*> pursuers;
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.control.max_speed_m_per_s < params.pursuer_speed)
      return {.silent = "the limit of the speed cuts the pursuit"};
    if (agent.id == evader.id || !experiment.graph.Hears(agent.id, evader.id)) continue;
    nearest_m = std::min(nearest_m, Along(evader.law.axes, evader.p_W - agent.p_W).norm());
    pursuers.push_back(&agent);
  }
  if (pursuers.empty()) return {.silent = "nobody hears the evader"};
  const double way_m = LargestStart_m(experiment) + params.pursuer_speed * experiment.run.duration_s;
  const double left_m = nearest_m - params.radius_m, off_m = RoundingShare(experiment) * way_m;
  const auto ticks = [&](double m) { return std::max(0.0, std::ceil(m / (closing * h))); };
  const double closest_m = std::max(params.radius_m, nearest_m - closing * experiment.run.duration_s);
  HoldsFrom capture{ticks(left_m + off_m) * h, Bound::kAtMost};
  const bool is_sure = ticks(left_m - off_m) == ticks(left_m + off_m);  // else rounding decides: a tick more or less
  if (is_sure && IsDrivenAway(experiment, evader, pursuers, params.evader_speed * capture.time_s, params.radius_m))
    capture.bound = Bound::kEqual;
  return {.figures = {{{capture.time_s}, capture.bound}, {{closest_m}, Bound::kAtMost, "", way_m}},
          .holds_from = capture};
}

class CaptureMeter final : public LawMeter {
 public:
  CaptureMeter(const Experiment& experiment, std::span<const int> ids)
      : experiment_(&experiment), ids_(ids.begin(), ids.end()) {}
  void Adopt(const Experiment& now) override { experiment_ = &now; }
  void Add(const TeamRow& row) override {
    const LawConfig& law = experiment_->agent(ids_.front()).law;
    const auto p_W = [&](int id) { return Along(law.axes, row.motions[static_cast<std::size_t>(id - 1)].p_WB); };
    now_m_ = std::numeric_limits<double>::infinity();
    for (const int id : ids_)
      if (id != law.leader) now_m_ = std::min(now_m_, (p_W(id) - p_W(law.leader)).norm());
    closest_m_ = std::min(closest_m_, now_m_);
    if (!captured_s_ && closest_m_ <= ParamsOf<PursuitEvasionParams>(law).radius_m)
      captured_s_ = experiment_->time_s(row.tick);
  }
  std::vector<FigureValues> Figures() const override {
    return {{captured_s_}, {std::isinf(closest_m_) ? std::nullopt : std::optional(closest_m_)}};
  }
  std::optional<double> Curve() const override { return std::isinf(now_m_) ? std::nullopt : std::optional(now_m_); }

 private:
  const Experiment* experiment_;
  std::vector<int> ids_;
  double now_m_ = std::numeric_limits<double>::infinity(), closest_m_ = now_m_;
  std::optional<double> captured_s_;
};

}  // namespace

LawEntry PursuitEvasionLaw() {
  return {
      .name = "pursuit_evasion",
      .summary = "pursuers fly towards an evader, which flies away from the nearest: the law wants a velocity",
      .equation =
          "v_i = pursuer_speed (p_e - p_i) / |p_e - p_i|;  evader: v_e = evader_speed (p_e - p_j) / |p_e - p_j|",
      .tex =
          R"(\text{pursuer: } v_i = s_p \frac{p_e - p_i}{\lvert p_e - p_i \rvert}, \qquad \text{evader: } v_e = s_e \frac{p_e - p_j}{\lvert p_e - p_j \rvert})",
      .symbols = {{"pursuer_speed_m_per_s", "s_p"}, {"evader_speed_m_per_s", "s_e"}},
      .graph = "a pursuer hears the evader; the evader hears the agents from which it flees",
      .details =
          "e is the agent law.leader. It flees from j, the nearest agent that it hears, pursuer or not. "
          "Distances are along law.axes.\n"
          "An agent within capture_radius_m of the agent that it pursues, or flees from, stops; so does a "
          "pursuer that does not hear the evader, and an evader that hears no agent.",
      .theory =
          "a pursuer captures after at most min_i (|p_e - p_i| - capture_radius) / (pursuer_speed - evader_speed), "
          "over those that hear the evader; a single one that does not drive it past another agent captures "
          "exactly then",
      .source =
          "Isaacs, Differential games, Wiley 1965 (simple motion); several pursuers: Bakolas & Tsiotras, Relay "
          "pursuit of a maneuvering target using dynamic Voronoi diagrams, Automatica 48 (2012)",
      .parameters = kPursuitEvasionParameters,
      .figures = kPursuitEvasionFigures,
      .curve = LawCurve{.name = "distance to the evader",
                        .unit = "m",
                        .meaning = "of the nearest pursuer",
                        .decays = false,
                        .figure = "closest_m"},
      .drawing = {.leader = "evader", .pictures = {}},
      .read = ReadPursuitEvasion,
      .make = MakeOf<PursuitEvasion>,
      .wanted = WantsVelocity,
      .predict = PredictPursuitEvasion,
      .meter = MeterOf<CaptureMeter>};
}

}  // namespace mascot
