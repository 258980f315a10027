// Distance-based formation; Krick, Broucke & Francis (2009):
//   v_i = -gain sum_j a_ij (|z|^2 - d_ij^2) z,  z = p_i - p_j,  d_ij the distance between the places of i and j
// The team goes down the gradient of V = (1/4) sum over edges a_ij (|z|^2 - d_ij^2)^2: V never grows, the centroid
// stays. Near an infinitesimally rigid shape all distances are reached exponentially, wherever it is and however it is
// turned. From far away they may end up wrong. Two agents: |z|^2 = d^2 / (1 + (d^2/|z(0)|^2 - 1) exp(-4 gain d^2 t)).
// Near the shape the sampled team is as stable as p+ = p - T 2 gain R'R p, with R the rigidity matrix. What becomes of
// a start is found by flying the sampled law ahead.
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/distance_formation/distance_theory.h"
#include "agent/laws/parts/fly_ahead.h"
#include "agent/laws/parts/places.h"
#include "agent/laws/parts/rigidity.h"
#include "agent/laws/parts/row_parts.h"

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
    {.name = "settling_time_s", .meaning = "from which on every distance between neighbours is within 1 % of its own"},
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

class DistanceFormationMeter final : public LawMeter {
 public:
  DistanceFormationMeter(const Experiment& experiment, std::span<const int> ids)
      : now_(&experiment), id_(ids.front()), start_W_(CentroidOf(StartsOf(experiment))) {}
  void Adopt(const Experiment& now) override { now_ = &now; }
  void Add(const TeamRow& row) override {
    const LawConfig& law = now_->agent(id_).law;
    const std::vector<Eigen::Vector3d> p_W = PositionsOf(row.motions);
    const std::vector<Bar> bars = BarsOf(now_->graph);
    error_m_ = LargestDistanceError(bars, law, p_W, false);
    drift_m_ = Along(law.axes, CentroidOf(p_W) - start_W_).norm();
    settling_.Add(row.tick, LargestDistanceError(bars, law, p_W, true));
  }
  std::vector<FigureValues> Figures() const override {
    const auto from = settling_.from();
    return {{error_m_}, {drift_m_}, {from ? std::optional(now_->time_s(*from)) : std::nullopt}};
  }
  std::optional<double> Curve() const override { return error_m_; }

 private:
  const Experiment* now_;
  int id_;
  Eigen::Vector3d start_W_;
  std::optional<double> error_m_, drift_m_;
  SettlingMeter settling_{kShapeShare};
};

}  // namespace

LawEntry DistanceFormationLaw() {
  return {.name = "distance_formation",
          .summary = "agents keep the distances of a formation, at any place and turned somehow",
          .equation = "v_i = -gain sum_j a_ij (|z|^2 - d_ij^2) z,  z = p_i - p_j",
          .tex = R"(v_i = -k \sum_j a_{ij} \bigl( \lvert z \rvert^2 - d_{ij}^2 \bigr) z, \quad z = p_i - p_j)",
          .symbols = {{"gain", "k"}},
          .graph = "undirected, and infinitesimally rigid in the wanted shape",
          .details = "d_ij is the distance between the places of i and j. Distances are along law.axes.",
          .theory =
              "infinitesimally rigid: the distances are reached exponentially from near the shape; the centroid stays; "
              "two agents: |z|^2 = d^2 / (1 + (d^2/|z(0)|^2 - 1) exp(-4 gain d^2 t))",
          .source =
              "Krick, Broucke & Francis, Stabilisation of infinitesimally rigid formations of multi-robot networks, "
              "Int. J. Control 82 (2009)",
          .parameters = kDistanceFormationParameters,
          .figures = kDistanceFormationFigures,
          .curve = LawCurve{.name = "distance error", .unit = "m", .meaning = "the largest between neighbours"},
          .drawing = {},
          .read = ReadDistanceFormation,
          .make = MakeOf<DistanceFormation>,
          .wanted = WantsVelocity,
          .predict = PredictDistanceFormation,
          .meter = MeterOf<DistanceFormationMeter>};
}

}  // namespace mascot
