// Consensus in spite of agents that lie: W-MSR (weighted mean-subsequence-reduced) of LeBlanc, Zhang, Koutsoukos &
// Sundaram (2013). Of the positions heard, per axis, agent i leaves out the F largest of those above its own and the F
// smallest of those below, all of them if there are fewer:
//   v_i = gain sum over the rest of a_ij (p_j - p_i)
// If an honest agent hears at most F that lie, what is left lies between what honest agents say: with h gain sum_j a_ij
// <= 1 it never leaves the hull, per axis, of the honest starts. Honest agents agree on every (2F+1)-robust graph; on
// one that is not (F+1)-robust, liars can keep them apart.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/parts/agreement.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/resilient/honest.h"
#include "experiment/graph/robustness.h"

namespace mascot {
namespace {

constexpr Key kResilientParameters[] = {
    key::Integer("f", 0, kMaxAgents, "F: so many agents that an agent hears may lie").Default("1"),
    key::Number("gain", Above(0, 1000), "pull towards each neighbour that is left, times its weight")
        .Default("1.0")
        .Unit("1/s")
        .Live(),
};

constexpr LawFigure kResilientFigures[] = {
    {.name = "outside_m", .meaning = "farthest that an honest agent was outside the hull of honest starts, per axis"},
    {.name = "apart_m",
     .meaning = "largest distance between honest agents along an axis, at the end",
     .unpredicted = "how fast they agree depends on what is left out"},
    {.name = "robustness",
     .meaning = "r of the graph: 2F + 1 makes honest agents agree, F + 1 is needed",
     .unpredicted = "it is not computed for so many agents"},
};

struct ResilientParams final : LawParams {
  std::size_t f = 0;
  double gain = 0;  ///< 1/s
};

/// A neighbour along an axis: how far from the agent it says that it is, and its index in what the agent hears.
struct Way {
  double away_m = 0;
  double weight = 0;
  std::size_t index = 0;
};

void PutWays(std::vector<Way>& ways, Eigen::Index axis, const Motion& self, std::span<const Heard> heard) {
  ways.clear();
  for (const Heard& j : heard) ways.push_back({j.motion.p_WB[axis] - self.p_WB[axis], j.weight, ways.size()});
}

/// W-MSR: sorts `ways`, and returns them without the `f` farthest on either side, or all of a side that has fewer.
std::span<const Way> Rest(std::vector<Way>& ways, std::size_t f) {
  std::ranges::stable_sort(ways, {}, &Way::away_m);
  const auto below =
      static_cast<std::size_t>(std::ranges::count_if(ways, [](const Way& way) { return way.away_m < 0; }));
  const auto above =
      static_cast<std::size_t>(std::ranges::count_if(ways, [](const Way& way) { return way.away_m > 0; }));
  const std::size_t first = std::min(f, below), end = ways.size() - std::min(f, above);
  return std::span(ways).subspan(first, end - first);
}

class Resilient final : public Law {
 public:
  explicit Resilient(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<ResilientParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      PutWays(ways_, axis, self, heard);
      for (const Way& way : Rest(ways_, params_->f)) v_W[axis] += params_->gain * way.weight * way.away_m;
    }
    return v_W;
  }

 private:
  const ResilientParams* params_ = nullptr;  // the experiment owns them
  std::vector<Way> ways_;                    // scratch
};

std::vector<std::uint8_t> LeftOutByResilient(const LawConfig& law, const Motion& self, std::span<const Heard> heard) {
  std::vector<std::uint8_t> left_out(heard.size());
  std::vector<Way> ways;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    PutWays(ways, axis, self, heard);
    std::vector<bool> is_used(heard.size());
    for (const Way& way : Rest(ways, ParamsOf<ResilientParams>(law).f)) is_used[way.index] = true;
    for (std::size_t k = 0; k < heard.size(); ++k)
      if (!is_used[k]) left_out[k] = static_cast<std::uint8_t>(left_out[k] | 1u << axis);
  }
  return left_out;
}

std::shared_ptr<const LawParams> ReadResilient(const Experiment& /*experiment*/, const LawConfig& /*law*/,
                                               Section& section) {
  auto params = std::make_shared<ResilientParams>();
  params->f = static_cast<std::size_t>(section.Integer("f"));
  params->gain = section.Number("gain");
  return params;
}

LawTheory PredictResilient(const Experiment& experiment) {
  const auto& params = ParamsOf<ResilientParams>(experiment.law);
  if (std::string why = WhyNotIdeal(WithoutFalseData(experiment), Wanted::kVelocity); !why.empty())
    return {.silent = std::move(why)};
  const std::optional<int> robustness = RobustnessOf(experiment.graph);
  LawTheory theory{.figures = {{}, {}, {}}, .warnings = RobustnessWarnings(robustness, static_cast<int>(params.f))};
  if (robustness) theory.figures[2] = {.values = {*robustness}};
  const double largest = 1 / (experiment.period_s() * LargestDegree(experiment.graph));
  const auto [hearer, liars] = MaxLiarsHeard(experiment);
  theory.figures[0].why = params.gain > largest ? "law.gain is too high" : "more lie than law.f leaves out";
  if (params.gain > largest)
    theory.warnings.push_back(fmt::format(
        "law.gain: expected at most {:.4g} 1/s at this control period and graph: agents overshoot", largest));
  else if (liars > params.f)
    theory.warnings.push_back(
        fmt::format("law.f: agent {} hears {} that lie: more than F = {} are not left out", hearer, liars, params.f));
  else
    theory.figures[0] = {.values = {0.0}, .bound = Bound::kAtMost};
  return theory;
}

class ResilientMeter final : public LawMeter {
 public:
  ResilientMeter(const Experiment& experiment, std::span<const int> ids)
      : honest_(experiment, ids), robustness_(RobustnessOf(experiment.graph)) {}
  void Add(const TeamRow& row) override { honest_.Add(row); }
  std::vector<FigureValues> Figures() const override {
    return {{honest_.outside_m()}, {honest_.apart_m()}, {robustness_}};
  }

 private:
  InitialHull honest_;
  std::optional<double> robustness_;
};

}  // namespace

LawEntry ResilientLaw() {
  return {
      .name = "resilient",
      .summary = "single integrators meet in spite of agents that lie: the law wants a velocity",
      .equation = "v_i = gain sum_j a_ij (p_j - p_i), per axis without the F largest above and the F smallest below",
      .tex = R"(v_i = k \sum_{j \in R_i} a_{ij} (p_j - p_i) \text{, per axis} \\
R_i \text{: what } i \text{ hears, without the } F \text{ largest above and the } F \text{ smallest below})",
      .symbols = {{"gain", "k"}, {"f", "F"}},
      .graph = "(2F + 1)-robust",
      .details =
          "Of the positions above its own, an agent leaves out the F farthest, or all if there are fewer, and so it "
          "does of the positions below. Positions equal to its own are never left out.",
      .theory =
          "with at most F liars heard by an honest agent and h gain sum_j a_ij <= 1, honest agents stay in the "
          "hull of honest starts, and agree if the graph is (2F+1)-robust",
      .source =
          "LeBlanc, Zhang, Koutsoukos & Sundaram, Resilient asymptotic consensus in robust networks, IEEE J. Selected "
          "Areas in Communications 31 (2013)",
      .parameters = kResilientParameters,
      .figures = kResilientFigures,
      .agrees = true,
      .gathers = true,
      .drawing = {.pictures = kDisagreementPicture, .telling = "position"},
      .read = ReadResilient,
      .make = MakeOf<Resilient>,
      .wanted = WantsVelocity,
      .left_out = LeftOutByResilient,
      .liars_left_out = [](const LawConfig& law) { return ParamsOf<ResilientParams>(law).f; },
      .predict = PredictResilient,
      .meter = MeterOf<ResilientMeter>};
}

}  // namespace mascot
