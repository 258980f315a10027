// Coverage of a region by single integrators; Cortes, Martinez, Karatas & Bullo (2004):
//   v_i = -gain (p_i - C_i),   C_i the centroid of V_i, the part of the region that is nearer to i than to all it hears
// (in x and y; heights are held). The cost H = sum_i (integral over V_i of |q - p_i|^2 phi(q)) / (integral of phi over
// the region) is the mean square distance to the nearest agent. If all hear all, it falls at every tick, also sampled,
// for gain T <= 2: about C_i, the cost of a cell that does not change is quadratic, and new cells make it smaller
// again.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/ideal.h"
#include "agent/laws/polygon.h"
#include "agent/laws/row_parts.h"

namespace mascot {
namespace {

constexpr Key kCoverageParameters[] = {
    key::Rows("region_m", {-1e6, 1e6}, "corners [x, y] of a convex region, counterclockwise").Required(),
    key::Rows("density", {-1e6, 1e6}, "bumps [x, y, width, weight] of Gaussian shape").Otherwise("uniform"),
    key::Number("gain", Above(0, 1000), "pull towards the centroid of the own cell").Default("1.0").Unit("1/s").Live(),
};

constexpr LawFigure kCoverageFigures[] = {
    {.name = "cost_start_m2", .meaning = "mean square distance of the region to the nearest agent, at the start"},
    {.name = "cost_end_m2", .meaning = "the same at the end"},
    {.name = "largest_increase_m2", .meaning = "the most by which it grew in a tick"},
};

struct CoverageParams final : LawParams {
  Polygon region;
  std::vector<Bump> bumps;
  double gain = 0;
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
    const Moments moments = MomentsOf(cell, p, params_->bumps);
    Eigen::Vector3d v_W = Eigen::Vector3d::Zero();
    if (moments.mass > 0) v_W.head<2>() = params_->gain * moments.first / moments.mass;
    return v_W;
  }

 private:
  const CoverageParams* params_ = nullptr;  // the experiment owns them
};

std::shared_ptr<const LawParams> ReadCoverage(const Experiment& /*experiment*/, const LawConfig& law,
                                              Section& section) {
  ExpectNoLeader(law, section);
  auto params = std::make_shared<CoverageParams>();
  const auto rows = [&section](const char* key, std::size_t size, const char* what) {
    const std::vector<std::vector<double>> read = section.Rows(key);
    for (std::size_t n = 0; n < read.size(); ++n)
      if (read[n].size() != size) section.FailRow(key, n, what);
    return section.Wrong(key) ? std::vector<std::vector<double>>() : read;
  };
  for (const auto& row : rows("region_m", 2, "expected a corner [x, y], got another number of values"))
    params->region.emplace_back(row[0], row[1]);
  if (!section.Wrong("region_m") && !IsConvex(params->region))
    section.Fail("region_m", "expected the corners of a convex region, counterclockwise, got others");
  for (const auto& row : rows("density", 4, "expected [x, y, width, weight], got another number of values")) {
    params->bumps.push_back({.centre_m = {row[0], row[1]}, .width_m = row[2], .weight = row[3]});
    if (row[2] <= 0 || row[3] <= 0) section.Fail("density", "expected widths and weights above 0, got others");
  }
  params->gain = section.Number("gain");
  return params;
}

/// H, with the positions p_W(id) of agents `ids`.
template <class Position>
double CostOf(const CoverageParams& params, std::span<const int> ids, Position p_W) {
  double cost = 0;
  for (const int i : ids) {
    const Eigen::Vector2d p = p_W(i).template head<2>();
    Polygon cell = params.region;
    for (const int j : ids)
      if (j != i) cell = Nearer(cell, p, p_W(j).template head<2>());
    cost += MomentsOf(cell, p, params.bumps).second;
  }
  return cost / MomentsOf(params.region, params.region[0], params.bumps).mass;
}

LawTheory PredictCoverage(const Experiment& experiment) {
  const auto& params = ParamsOf<CoverageParams>(experiment.law);
  const auto ids = AgentsWith(EntryOf(experiment.law), experiment);
  const double start_m2 = CostOf(params, ids, [&](int id) { return experiment.agent(id).p_W; });
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  for (const int id : ids)
    if (experiment.graph.HeardBy(id).size() + 1 < ids.size())
      return {.silent = "agents that do not hear all others do not know what is nearer to them"};
  if (params.gain * experiment.period_s() > 2) return {.silent = "law.gain is more than 2 per control period"};
  constexpr double kRounding = 1e-12;
  PredictedFigure increase{.values = {kRounding * start_m2}, .bound = Bound::kAtMost};
  if (!params.bumps.empty()) increase.values = {};  // the integrals are not exact
  return {.figures = {{{start_m2}}, {{start_m2}, Bound::kAtMost}, std::move(increase)}};
}

class CoverageMeter final : public LawMeter {
 public:
  CoverageMeter(const Experiment& experiment, std::span<const int> ids)
      : params_(ParamsOf<CoverageParams>(experiment.agent(ids.front()).law)), ids_(ids.begin(), ids.end()) {}
  void Add(const TeamRow& row) override {
    const std::optional<double> before_m2 = now_m2_;
    now_m2_ = CostOf(params_, ids_, [&](int id) { return row.motions[static_cast<std::size_t>(id - 1)].p_WB; });
    if (!start_m2_) start_m2_ = now_m2_;
    if (before_m2) increase_m2_ = std::max(increase_m2_.value_or(*now_m2_ - *before_m2), *now_m2_ - *before_m2);
  }
  std::vector<FigureValues> Figures() const override { return {{start_m2_}, {now_m2_}, {increase_m2_}}; }

 private:
  CoverageParams params_;
  std::vector<int> ids_;
  std::optional<double> start_m2_, now_m2_, increase_m2_;
};

}  // namespace

LawEntry CoverageLaw() {
  return {
      .name = "coverage",
      .summary = "agents spread over a region, each to the centroid of what is nearest to it: the law wants a velocity",
      .equation = "v_i = -gain (p_i - C_i), C_i the centroid of i's Voronoi cell among what it hears",
      .theory =
          "if all hear all, the mean square distance to the nearest agent falls at every tick for gain T <= 2, to a "
          "centroidal Voronoi partition",
      .source =
          "Cortes, Martinez, Karatas & Bullo, Coverage control for mobile sensing networks, IEEE Trans. Robotics and "
          "Automation 20 (2004)",
      .parameters = kCoverageParameters,
      .figures = kCoverageFigures,
      .drawing = {.pictures = {}, .cells = "region_m"},
      .read = ReadCoverage,
      .make = MakeOf<Coverage>,
      .wanted = WantsVelocity,
      .predict = PredictCoverage,
      .meter = MeterOf<CoverageMeter>};
}

}  // namespace mascot
