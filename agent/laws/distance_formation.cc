// Distance-based formation; Krick, Broucke & Francis (2009):
//   v_i = -gain sum_j a_ij (|z|^2 - d_ij^2) z,  z = p_i - p_j,  d_ij the distance between the places of i and j
// The team goes down the gradient of V = (1/4) sum over edges a_ij (|z|^2 - d_ij^2)^2: V never grows, the centroid
// stays. Near an infinitesimally rigid shape all distances are reached exponentially, wherever it is and however it is
// turned. From far away they may end up wrong. Two agents: |z|^2 = d^2 / (1 + (d^2/|z(0)|^2 - 1) exp(-4 gain d^2 t)).
// Near the shape the sampled team is as stable as p+ = p - T 2 gain R'R p, with R the rigidity matrix.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/distance_descent.h"
#include "agent/laws/ideal.h"
#include "agent/laws/places.h"
#include "agent/laws/rigidity.h"
#include "agent/laws/row_parts.h"
#include "agent/laws/stable_period.h"

namespace mascot {
namespace {

constexpr auto kDistanceFormationParameters =
    Joined(kPlaceKeys, std::array{
                           key::Number("gain", {0, 1000}, "a pair settles at its distance d at the rate 4 gain d^2")
                               .Default("0.05")
                               .Unit("1/(m^2 s)")
                               .Live(),
                       });

constexpr LawFigure kDistanceFormationFigures[] = {
    {.name = "distance_error_m", .meaning = "largest error of the distance between neighbours, at the end"},
    {.name = "centroid_drift_m", .meaning = "way of the agents' mean from its start, at the end"},
};

struct DistanceFormationParams final : LawParams {
  std::vector<Eigen::Vector3d> d_W;  ///< each agent's place, by id - 1 (m)
  double gain = 0;                   ///< 1/(m^2 s)
};

class DistanceFormation final : public Law {
 public:
  explicit DistanceFormation(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { agent_ = &agent; }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const auto& params = ParamsOf<DistanceFormationParams>(agent_->law);
    Eigen::Vector3d descent_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) {
      const Eigen::Vector3d z_W = Along(agent_->law.axes, self.p_WB - j.motion.p_WB);
      const double d2 = SquareOf({agent_->id, j.id}, params.d_W, agent_->law.axes);
      descent_W -= j.weight * (z_W.squaredNorm() - d2) * z_W;
    }
    return params.gain * descent_W;
  }

 private:
  const AgentConfig* agent_ = nullptr;  // the experiment owns it
};

std::shared_ptr<const LawParams> ReadDistanceFormation(const Experiment& experiment, const LawConfig& law,
                                                       Section& section) {
  auto params = std::make_shared<DistanceFormationParams>();
  ExpectNoLeader(law, section);
  params->d_W = ReadPlaces(section, experiment.size());
  params->gain = section.Number("gain");
  ExpectRigid(experiment, params->d_W, law.axes, Rigidity::kLengths, section);
  return params;
}

/// The largest error of a distance between neighbours (m).
double LargestDistanceError(const Graph& graph, const LawConfig& law, std::span<const Eigen::Vector3d> p_W) {
  const auto& d_W = ParamsOf<DistanceFormationParams>(law).d_W;
  double largest_m = 0;
  for (const Bar& bar : BarsOf(graph))
    largest_m = std::max(largest_m, std::abs(LengthOf(bar, p_W, law.axes) - LengthOf(bar, d_W, law.axes)));
  return largest_m;
}

LawTheory PredictDistanceFormation(const Experiment& experiment) {
  const auto& params = ParamsOf<DistanceFormationParams>(experiment.law);
  if (std::string why = WhyNotIdeal(experiment, Wanted::kVelocity); !why.empty()) return {.silent = std::move(why)};
  if (experiment.size() > kMostAgentsOfRigidity) return {.silent = "the team is large: its rigidity is not checked"};
  const Axes axes = experiment.law.axes;
  const std::vector<Bar> bars = BarsOf(experiment.graph);
  const double stiffness_m2 = LargestStiffness(bars, params.d_W, axes);
  if (auto unstable = WhyUnstable(experiment, 1 / (params.gain * stiffness_m2))) return *unstable;
  const std::vector<Eigen::Vector3d> starts_W = StartsOf(experiment);
  const double step = experiment.period_s() * params.gain;
  PredictedFigure error;
  if (bars.size() == 1)
    error = {.values = {ErrorOfTwo(bars[0], params.d_W, starts_W, axes, step, experiment.ticks())}};
  else if (PotentialNeverGrows(bars, params.d_W, starts_W, axes, step))
    error = {.values = {LargestErrorBelow(bars, params.d_W, starts_W, axes)}, .bound = Bound::kAtMost};
  if (error.values.empty() || !std::isfinite(*error.values[0]))
    return {.silent = "the start is too far from the shape for the control period"};
  return {.figures = {std::move(error), {.values = {0.0}}}};
}

class DistanceFormationMeter final : public LawMeter {
 public:
  DistanceFormationMeter(const Experiment& experiment, std::span<const int> ids)
      : now_(&experiment), id_(ids.front()), start_W_(CentroidOf(StartsOf(experiment))) {}
  void Adopt(const Experiment& now) override { now_ = &now; }
  void Add(const TeamRow& row) override {
    const LawConfig& law = now_->agent(id_).law;
    const std::vector<Eigen::Vector3d> p_W = PositionsOf(row.motions);
    figures_ = {{LargestDistanceError(now_->graph, law, p_W)}, {Along(law.axes, CentroidOf(p_W) - start_W_).norm()}};
  }
  std::vector<FigureValues> Figures() const override { return figures_; }

 private:
  const Experiment* now_;
  int id_;
  Eigen::Vector3d start_W_;
  std::vector<FigureValues> figures_ = {{{}}, {{}}};
};

}  // namespace

LawEntry DistanceFormationLaw() {
  return {.name = "distance_formation",
          .summary = "agents keep the distances of a formation, at any place and turned somehow",
          .equation = "v_i = -gain sum_j a_ij (|z|^2 - d_ij^2) z,  z = p_i - p_j",
          .details = "d_ij is the distance between the places of i and j. Distances are along law.axes.",
          .theory =
              "infinitesimally rigid: the distances are reached exponentially from near the shape; the centroid stays; "
              "two agents: |z|^2 = d^2 / (1 + (d^2/|z(0)|^2 - 1) exp(-4 gain d^2 t))",
          .source =
              "Krick, Broucke & Francis, Stabilisation of infinitesimally rigid formations of multi-robot networks, "
              "Int. J. Control 82 (2009)",
          .parameters = kDistanceFormationParameters,
          .figures = kDistanceFormationFigures,
          .drawing = {},
          .read = ReadDistanceFormation,
          .make = MakeOf<DistanceFormation>,
          .wanted = WantsVelocity,
          .predict = PredictDistanceFormation,
          .meter = MeterOf<DistanceFormationMeter>};
}

}  // namespace mascot
