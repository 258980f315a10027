// Bearing-only formation; Zhao & Zelazo (2016):
//   v_i = -gain sum_j a_ij P(g_ij) g*_ij,  P(g) = I - g g'
// g_ij is the direction from agent i to agent j, g*_ij the one between their places. An agent needs no distance. The
// sum of v_i is 0 and P(g_ij) takes what is along g_ij, so the centroid and the scale (the rms distance from it) stay.
// Held for a tick, velocities across the way make the scale s grow: N s^2 by T^2 sum |v_i|^2. On an infinitesimally
// bearing rigid framework all directions are reached from almost any start: from all but those that lead to the shape
// mirrored in its centroid. Near the shape the sampled team is as stable as p+ = p - T gain H p, H the sum over edges
// of a_ij P(g) / |z|. What becomes of a start is found by flying the sampled law ahead.
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "agent/laws/bearing_formation/bearing_theory.h"
#include "agent/laws/parts/fly_ahead.h"
#include "agent/laws/parts/places.h"
#include "agent/laws/parts/rigidity.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr auto kBearingFormationParameters =
    Joined(kPlaceKeysWithoutScale,
           std::array{
               key::Number("gain", {0, 1000}, "speed per neighbour that is seen at right angles to its place")
                   .Default("1.0")
                   .Unit("m/s")
                   .Live(),
           });

constexpr LawFigure kBearingFormationFigures[] = {
    {.name = "bearing_error_deg", .meaning = "largest error of the direction to a neighbour, at the end"},
    {.name = "scale_ratio", .meaning = "rms distance from the agents' mean, as a multiple of that at the start"},
    {.name = "centroid_drift_m", .meaning = "way of the agents' mean from its start, at the end"},
    {.name = "settling_time_s", .meaning = "from which on every direction is within 1 degree of its own"},
};

class BearingFormation final : public Law {
 public:
  explicit BearingFormation(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { agent_ = &agent; }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const auto& params = ParamsOf<BearingFormationParams>(agent_->law);
    const Axes axes = agent_->law.axes;
    Eigen::Vector3d turn_W = Eigen::Vector3d::Zero();
    for (const Heard& j : heard) {
      const Eigen::Vector3d g = Along(axes, j.motion.p_WB - self.p_WB).normalized();  // 0 if they are in one place
      const Eigen::Vector3d wanted_g = SpanOf({agent_->id, j.id}, params.d_W, axes).normalized();
      turn_W -= j.weight * (wanted_g - g * g.dot(wanted_g));
    }
    return params.gain * turn_W;
  }

 private:
  const AgentConfig* agent_ = nullptr;  // the experiment owns it
};

std::shared_ptr<const LawParams> ReadBearingFormation(const Experiment& experiment, const LawConfig& law,
                                                      Section& section) {
  auto params = std::make_shared<BearingFormationParams>();
  ExpectNoLeader(law, section);
  params->d_W = ReadPlaces(section, experiment.size(), PlaceScale::kNone);
  params->gain = section.Number("gain");
  ExpectRigid(experiment, params->d_W, law.axes, Rigidity::kBearings, section);
  return params;
}

class BearingFormationMeter final : public LawMeter {
 public:
  BearingFormationMeter(const Experiment& experiment, std::span<const int> ids) : now_(&experiment), id_(ids.front()) {
    start_W_ = StartsOf(experiment);
    start_m_ = ScaleOf(start_W_, axes());
  }
  void Adopt(const Experiment& now) override { now_ = &now; }
  void Add(const TeamRow& row) override {
    p_W_ = PositionsOf(row.motions);
    error_deg_ = LargestTurn_deg(BarsOf(now_->graph), now_->agent(id_).law, p_W_);
    settling_.Add(row.tick, error_deg_);
  }
  std::vector<FigureValues> Figures() const override {
    const Eigen::Vector3d drift_W = CentroidOf(p_W_) - CentroidOf(start_W_);
    const auto from = settling_.from();
    return {{error_deg_},
            {ScaleOf(p_W_, axes()) / start_m_},
            {Along(axes(), drift_W).norm()},
            {from ? std::optional(now_->time_s(*from)) : std::nullopt}};
  }
  std::optional<double> Curve() const override { return error_deg_; }

 private:
  Axes axes() const { return now_->agent(id_).law.axes; }
  const Experiment* now_;
  int id_;
  std::vector<Eigen::Vector3d> start_W_, p_W_;
  double start_m_ = 0, error_deg_ = 0;
  SettlingMeter settling_{kSettled_deg};
};

}  // namespace

LawEntry BearingFormationLaw() {
  return {
      .name = "bearing_formation",
      .summary = "agents reach the directions of a formation, with its scale and place as they were",
      .equation = "v_i = -gain sum_j a_ij P(g_ij) g*_ij,  P(g) = I - g g'",
      .tex = R"(v_i = -k \sum_j a_{ij} P(g_{ij})\, g^*_{ij}, \quad P(g) = I - g g^\top)",
      .symbols = {{"gain", "k"}},
      .graph = "undirected, and infinitesimally bearing rigid in the wanted shape",
      .details =
          "g_ij is the direction from i to j and g*_ij that from the place of i to the place of j, along "
          "law.axes. Of an agent in the same place, g_ij = 0.",
      .theory =
          "infinitesimally bearing rigid: all directions are reached from almost any start; the centroid stays, and "
          "the scale but for what holding a command adds",
      .source =
          "Zhao & Zelazo, Bearing rigidity and almost global bearing-only formation stabilization, IEEE Trans. Autom. "
          "Control 61 (2016)",
      .parameters = kBearingFormationParameters,
      .figures = kBearingFormationFigures,
      .curve = LawCurve{.name = "bearing error", .unit = "deg", .meaning = "the largest"},
      .drawing = {},
      .read = ReadBearingFormation,
      .make = MakeOf<BearingFormation>,
      .wanted = WantsVelocity,
      .predict = PredictBearingFormation,
      .meter = MeterOf<BearingFormationMeter>};
}

}  // namespace mascot
