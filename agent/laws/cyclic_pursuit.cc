// Cyclic pursuit: agent i flies after agent i + 1, agent N after agent 1, each turned by alpha to the right of it;
// Marshall, Broucke & Francis (2004), Pavone & Frazzoli (2007):
//   v_i = gain R(alpha) (p_{i+1} - p_i),  R(alpha) = [cos alpha, sin alpha; -sin alpha, cos alpha] in x and y
// The centre stays. A regular N-gon stays regular: its radius grows at the rate gain (cos(2 pi/N - alpha) - cos alpha),
// its agents go round at the rate gain (sin(2 pi/N - alpha) + sin alpha) to the left. From almost any start agents
// meet (|alpha| < pi/N), circle at 2 gain sin(pi/N) (alpha = pi/N), or spiral out. Theory has the sampled motion.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "agent/laws/agreement.h"
#include "agent/laws/cyclic_modes.h"
#include "agent/laws/ideal.h"
#include "agent/laws/row_parts.h"

namespace mascot {
namespace {

constexpr Key kCyclicPursuitParameters[] = {
    key::Number("gain", {0, 1000}, "speed at 1 m from the next agent; weights of the graph do not count")
        .Default("1.0")
        .Unit("1/s")
        .Live(),
    key::Number("alpha_deg", {-180, 180}, "turn to the right of the way to the next agent; 180 / N: a circle")
        .Default("0.0")
        .Live(),
};

constexpr LawFigure kCyclicPursuitFigures[] = {
    {.name = "radius_m", .meaning = "rms distance from the centre in x and y, at the end"},
    {.name = "radius_ratio", .meaning = "that as a multiple of what it was at the start"},
    {.name = "turn_rate_rad_per_s", .meaning = "at which agents go round the centre to the left, at the end"},
};

struct CyclicPursuitParams final : LawParams {
  double gain = 0;  ///< 1/s
  double alpha_rad = 0;
};

int NextOf(int id, int agents) { return id == agents ? 1 : id + 1; }

class CyclicPursuit final : public Law {
 public:
  CyclicPursuit(const AgentConfig& agent, int next) : next_(next) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override {
    const auto& params = ParamsOf<CyclicPursuitParams>(agent.law);
    const double c = std::cos(params.alpha_rad), s = std::sin(params.alpha_rad);
    turn_ << params.gain * c, params.gain * s, 0, -params.gain * s, params.gain * c, 0, 0, 0, params.gain;
  }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    for (const Heard& j : heard)
      if (j.id == next_) return turn_ * (j.motion.p_WB - self.p_WB);
    return Eigen::Vector3d::Zero();
  }

 private:
  int next_;
  Eigen::Matrix3d turn_;  // gain R(alpha)
};

std::shared_ptr<const LawParams> ReadCyclicPursuit(const Experiment& experiment, const LawConfig& law,
                                                   Section& section) {
  auto params = std::make_shared<CyclicPursuitParams>();
  ExpectNoLeader(law, section);
  params->gain = section.Number("gain");
  params->alpha_rad = section.Number("alpha_deg") * std::numbers::pi / 180;
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
  LawTheory theory{
      .figures = {{.values = {radius_m}}, {.values = {radius_m / start_m}}, {.values = {turn_rate_rad_per_s}}}};
  if (modes.Meet()) theory.value_m = MeanStart(experiment);
  return theory;
}

class CyclicPursuitMeter final : public LawMeter {
 public:
  CyclicPursuitMeter(const Experiment& experiment, std::span<const int> ids)
      : period_s_(experiment.period_s()), ids_(ids.begin(), ids.end()) {}
  void Add(const TeamRow& row) override {
    before_ = std::exchange(now_, {});
    for (const int id : ids_) now_.emplace_back(row.motions[static_cast<std::size_t>(id - 1)].p_WB.head<2>());
    motion_ = RingMotionOf(before_.empty() ? now_ : before_, now_, period_s_);
    if (row.tick == 0) start_m_ = motion_.radius_m;
  }
  std::vector<FigureValues> Figures() const override {
    if (start_m_ < kRoundedRadius_m) return {{motion_.radius_m}, {{}}, {{}}};
    return {{motion_.radius_m}, {motion_.radius_m / start_m_}, {motion_.turn_rate_rad_per_s}};
  }

 private:
  double period_s_;
  std::vector<int> ids_;
  std::vector<Eigen::Vector2d> before_, now_;
  RingMotion motion_;
  double start_m_ = 0;
};

}  // namespace

LawEntry CyclicPursuitLaw() {
  return {.name = "cyclic_pursuit",
          .summary = "each agent flies after the next one of a ring: to a point, on a circle, on spirals",
          .equation = "v_i = gain R(alpha) (p_{i+1} - p_i), R(alpha) a turn to the right in x and y",
          .theory =
              "the centre stays; |alpha| < pi/N: agents meet; alpha = pi/N: they circle at 2 gain sin(pi/N); beyond: "
              "spirals that open; a regular N-gon stays regular, its radius grows at the rate gain (cos(2 pi/N - "
              "alpha) - cos alpha)",
          .source =
              "Marshall, Broucke & Francis, Formations of vehicles in cyclic pursuit, IEEE Trans. Autom. Control 49 "
              "(2004); Pavone & Frazzoli, Decentralized policies for geometric pattern formation and path coverage, J. "
              "Dyn. Syst. Meas. Control 129 (2007)",
          .parameters = kCyclicPursuitParameters,
          .figures = kCyclicPursuitFigures,
          .drawing = {.pictures = kDisagreementPicture},
          .read = ReadCyclicPursuit,
          .make = MakeCyclicPursuit,
          .wanted = WantsVelocity,
          .predict = PredictCyclicPursuit,
          .meter = MeterOf<CyclicPursuitMeter>};
}

}  // namespace mascot
