// Rendezvous without losing an agent; Ji & Egerstedt (2007). Agents hear all others within D = graph.range_m:
//   v_i = gain sum_j (2 D - l_ij) / (D - l_ij)^2 (p_j - p_i),   l_ij = |p_j - p_i|
// This is the gradient of a tension that grows beyond all bounds as an edge comes close to D: an edge that counts is
// never lost, the mean stays, and a team that is connected meets there. A new neighbour counts from a distance of
// D - margin_m on (the paper's hysteresis), because its tension would be unbounded at D; if j counts for i, then i
// counts for j, since both see the same distance.
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/parts/agreement.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"
#include "agent/laws/rendezvous/tension.h"

namespace mascot {
namespace {

constexpr Key kRendezvousParameters[] = {
    key::Number("gain", Above(0, 1000), "speed, times a function of the distance that is small near a neighbour")
        .Default("1.0")
        .Unit("m/s")
        .Live(),
    key::Number("margin_m", {0, 1e6}, "how much closer than graph.range_m an agent must be to count, once"),
};

constexpr LawFigure kRendezvousFigures[] = {
    {.name = "edges_lost", .meaning = "how many pairs counted for each other, and were out of range later"},
};

struct RendezvousParams final : LawParams {
  Tension tension;
};

class Rendezvous final : public Law {
 public:
  explicit Rendezvous(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { params_ = &ParamsOf<RendezvousParams>(agent.law); }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    std::set<int> counted;
    Eigen::Vector3d pull_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) {
      const Eigen::Vector3d way_W = j.motion.p_WB - self.p_WB;
      const double l = way_W.norm();
      if (!params_->tension.Counts(l, counted_.contains(j.id))) continue;
      counted.insert(j.id);
      pull_W += params_->tension.Stiffness(l) * way_W;
    }
    counted_ = std::move(counted);
    return pull_W;
  }

 private:
  const RendezvousParams* params_ = nullptr;  // the experiment owns them
  std::set<int> counted_;                     // ids of the agents that counted at the last tick
};

std::shared_ptr<const LawParams> ReadRendezvous(const Experiment& experiment, const LawConfig& /*law*/,
                                                Section& section) {
  auto params = std::make_shared<RendezvousParams>();
  Tension& tension = params->tension;
  tension.gain = section.Number("gain");
  tension.range_m = experiment.schedule.range_m();
  tension.margin_m = section.Number("margin_m", 0.1 * tension.range_m);
  if (tension.range_m == 0)
    section.Fail("name",
                 "expected graph.range_m, within which agents hear each other, for the law rendezvous, got none");
  else if (tension.margin_m >= tension.range_m)
    section.Fail("margin_m", "expected less than graph.range_m = " + ShortestFloat(tension.range_m) + ", got " +
                                 ShortestFloat(tension.margin_m));
  return params;
}
LawTheory PredictRendezvous(const Experiment& experiment) {
  const auto& params = ParamsOf<RendezvousParams>(experiment.law);
  Experiment anywhere = experiment;
  anywhere.schedule = experiment.schedule.WithRange(0);
  if (std::string why = WhyNotIdealUndirected(anywhere); !why.empty()) return {.silent = std::move(why)};
  const Graph stiffness = StiffnessAtStart(experiment, params.tension);
  if (stiffness.Roots().empty())
    return {.silent = "the agents within graph.range_m less law.margin_m at the start are not connected"};
  if (experiment.period_s() * LargestDegree(stiffness) >= 1)
    return {.silent = "the tension at the start is too high for the control period"};
  const std::optional<bool> keeps = KeepsEveryEdge(experiment, params.tension);
  if (!keeps) return {.silent = "so many agents are not flown ahead for so many ticks, to see that no edge is lost"};
  if (!*keeps) return {.silent = "an edge is lost on the way: the tension becomes too high for the control period"};
  return {.figures = {{.values = {0}}}, .value_m = MeanStart(experiment), .unlimited = true};
}

class RendezvousMeter final : public LawMeter {
 public:
  RendezvousMeter(const Experiment& experiment, std::span<const int> ids)
      : experiment_(&experiment), ids_(ids.begin(), ids.end()) {}
  void Adopt(const Experiment& now) override { experiment_ = &now; }

  void Add(const TeamRow& row) override {
    for (const int i : ids_)
      for (const Graph::Neighbour& j : experiment_->graph.HeardBy(i)) {
        if (j.id < i) continue;
        const auto p_W = [&](int id) { return row.motions[static_cast<std::size_t>(id - 1)].p_WB; };
        const bool counted = pairs_.contains({i, j.id});
        const auto& params = ParamsOf<RendezvousParams>(experiment_->agent(i).law);
        if (params.tension.Counts((p_W(j.id) - p_W(i)).norm(), counted)) {
          pairs_.insert({i, j.id});
        } else if (counted) {
          pairs_.erase({i, j.id});
          ++lost_;
        }
      }
  }
  std::vector<FigureValues> Figures() const override { return {{lost_}}; }

 private:
  const Experiment* experiment_;
  std::vector<int> ids_;
  std::set<std::pair<int, int>> pairs_;  // that count for each other
  double lost_ = 0;
};

}  // namespace

LawEntry RendezvousLaw() {
  return {
      .name = "rendezvous",
      .summary = "single integrators that hear each other within graph.range_m meet, and lose no neighbour",
      .equation = "v_i = gain sum_j (2 D - l) / (D - l)^2 (p_j - p_i),  l = |p_j - p_i|, D = graph.range_m",
      .tex =
          R"(v_i = k \sum_j \frac{2 D - \ell}{(D - \ell)^2}\, (p_j - p_i), \quad \ell = \lvert p_j - p_i \rvert, \quad D = \texttt{graph.range\_m})",
      .symbols = {{"gain", "k"}},
      .graph = "undirected, and connected at the start by edges shorter than graph.range_m - margin_m",
      .details =
          "l and D are distances in space, also where law.axes is \"xy\" and agents only move in the plane: "
          "heights count. Weights of the graph do not.\n"
          "j counts for i from the moment at which l < D - margin_m, and then as long as it is heard, which "
          "is up to D.",
      .theory =
          "undirected and connected: meets at the mean of p(0); no edge that counts is lost, because its tension "
          "grows beyond all bounds at D; sampled: for periods short against (D - l)^2 / (gain (2 D - l))",
      .source =
          "Ji & Egerstedt, Distributed coordination control of multiagent systems while preserving connectedness, "
          "IEEE Trans. Robotics 23 (2007)",
      .parameters = kRendezvousParameters,
      .figures = kRendezvousFigures,
      .agrees = true,
      .gathers = true,
      .drawing = {.pictures = kDisagreementPicture},
      .read = ReadRendezvous,
      .make = MakeOf<Rendezvous>,
      .wanted = WantsVelocity,
      .predict = PredictRendezvous,
      .meter = MeterOf<RendezvousMeter>};
}

}  // namespace mascot
