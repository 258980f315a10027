// Coverage of a region by single integrators; Cortes, Martinez, Karatas & Bullo (2004):
//   v_i = -gain (p_i - C_i),   C_i the centroid of V_i, the part of the region that is nearer to i than to all it hears
// (in x and y; heights are held). The cost H = sum_i (integral over V_i of |q - p_i|^2 phi(q)) / (integral of phi over
// the region) is the mean square distance to the nearest agent. If all hear all, it falls at every tick, also sampled,
// for gain T <= 2: about C_i, the cost of a cell that does not change is quadratic, and new cells make it smaller
// again. Agents at one place have one cell, which counts once.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/coverage/coverage_params.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/rigidity.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr LawFigure kCoverageFigures[] = {
    {.name = "cost_start_m2", .meaning = "mean square distance of the region to the nearest agent, at the start"},
    {.name = "cost_end_m2", .meaning = "the same at the end"},
    {.name = "largest_increase_m2", .meaning = "the most by which it grew in a tick"},
};

class Coverage final : public Law {
 public:
  explicit Coverage(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<CoverageParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const Eigen::Vector2d p = self.p_WB.head<2>();
    Polygon cell = params_->region;
    for (const Heard& j : heard) cell = Nearer(cell, p, j.motion.p_WB.head<2>());
    const Moments moments = params_->Of(cell, p);
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    if (moments.mass > 0) v_W.head<2>() = params_->gain * moments.first / moments.mass;
    return v_W;
  }

 private:
  const CoverageParams* params_ = nullptr;  // the experiment owns them
};

/// A warning of the first two agents that start at one place, and so have one cell and one velocity for ever.
std::vector<std::string> WarningsOfOnePlace(std::span<const int> ids, std::span<const Eigen::Vector3d> starts_W) {
  for (const int i : ids)
    for (const int j : ids)
      if (i < j &&
          starts_W[static_cast<std::size_t>(i - 1)].head<2>() == starts_W[static_cast<std::size_t>(j - 1)].head<2>())
        return {
            fmt::format("agents.position_m: agents {} and {} start at one place in x and y, have one cell, and never "
                        "part",
                        i, j)};
  return {};
}

LawTheory PredictCoverage(const Experiment& experiment) {
  const auto& params = ParamsOf<CoverageParams>(experiment.law);
  const auto ids = AgentsWith(EntryOf(experiment.law), experiment);
  const std::vector<Eigen::Vector3d> starts_W = StartsOf(experiment);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  for (const int id : ids)
    if (experiment.graph.HeardBy(id).size() + 1 < ids.size())
      return {.silent = "agents that do not hear all others do not know what is nearer to them"};
  if (params.gain * experiment.period_s() > 2) return {.silent = "law.gain is more than 2 per control period"};
  const double start_m2 = CoverageCost(params, ids, starts_W);
  const double off_m2 = params.bumps.empty() ? 0 : 1e-10 * start_m2;  // of the integrals of a density, beside rounding
  return {.figures = {{{start_m2}}, {{start_m2 + off_m2}, Bound::kAtMost}, {{off_m2}, Bound::kAtMost}},
          .warnings = WarningsOfOnePlace(ids, starts_W)};
}

class CoverageMeter final : public LawMeter {
 public:
  CoverageMeter(const Experiment& experiment, std::span<const int> ids)
      : params_(ParamsOf<CoverageParams>(experiment.agent(ids.front()).law)), ids_(ids.begin(), ids.end()) {}
  void Add(const TeamRow& row) override {
    const std::optional<double> before_m2 = now_m2_;
    now_m2_ = CoverageCost(params_, ids_, PositionsOf(row.motions));
    if (!start_m2_) start_m2_ = now_m2_;
    if (before_m2) increase_m2_ = std::max(increase_m2_.value_or(*now_m2_ - *before_m2), *now_m2_ - *before_m2);
  }
  std::vector<FigureValues> Figures() const override { return {{start_m2_}, {now_m2_}, {increase_m2_}}; }
  std::optional<double> Curve() const override { return now_m2_; }

 private:
  CoverageParams params_;
  std::vector<int> ids_;
  std::optional<double> start_m2_, now_m2_, increase_m2_;
};

std::span<const Eigen::Vector2d> CoverageRegion(const LawConfig& law) { return ParamsOf<CoverageParams>(law).region; }

}  // namespace

LawEntry CoverageLaw() {
  return {
      .name = "coverage",
      .summary = "agents spread over a region, each to the centroid of what is nearest to it: the law wants a velocity",
      .equation = "v_i = -gain (p_i - C_i), C_i the centroid of i's Voronoi cell among what it hears",
      .tex =
          R"(v_i = -k (p_i - C_i), \quad C_i = \frac{\int_{V_i} q\, \rho(q)\, dq}{\int_{V_i} \rho(q)\, dq}, \quad V_i \text{ the Voronoi cell of agent } i \text{ among what it hears})",
      .symbols = {{"gain", "k"}, {"density", R"(\rho)"}},
      .graph = "complete",
      .details =
          "Positions count in x and y alone. The cell is that part of the region which is at least as near "
          "to i as to every agent that i hears; an agent whose cell is empty wants the velocity 0. C_i is that of the "
          "density sum weight exp(-|q - [x, y]|^2 / (2 width^2)), of whatever width and wherever the bumps are.",
      .theory =
          "if all hear all, the mean square distance to the nearest agent falls at every tick for gain T <= 2, to a "
          "centroidal Voronoi partition",
      .source =
          "Cortes, Martinez, Karatas & Bullo, Coverage control for mobile sensing networks, IEEE Trans. Robotics and "
          "Automation 20 (2004)",
      .parameters = kCoverageParameters,
      .figures = kCoverageFigures,
      .curve = LawCurve{.name = "coverage cost",
                        .unit = "m^2",
                        .meaning = "mean square distance of the region to the nearest agent",
                        .decays = false,
                        .figure = "cost_end_m2"},
      .drawing = {.pictures = {}, .cells = {"region_m", CoverageRegion}},
      .read = ReadCoverage,
      .make = MakeOf<Coverage>,
      .wanted = WantsVelocity,
      .predict = PredictCoverage,
      .meter = MeterOf<CoverageMeter>};
}

}  // namespace mascot
