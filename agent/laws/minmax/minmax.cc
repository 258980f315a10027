// Min-max time consensus tracking, Mulla et al. (2017), on a directed spanning tree. Per axis, child c of
// parent p, with z = p_c - p_p, w = v_c - v_p and alpha = beta_c - beta_p > 0:
//   a_c = -beta_c sgn(2 alpha z + w |w|),  sgn(0) = 0
// The child meets its parent in min-max time: the shortest time in which it can meet a parent that makes the best use
// of its bound beta_p to avoid that.
//
// With a boundary layer l > 0 the switching curve gets a linear piece and sgn a linear zone, as in the proximate
// time-optimal servomechanism of Workman, Kosut & Franklin (ACC 1987):
//   a_c = -beta_c sat((w + f(z)) / s),   s = sqrt(alpha l / 2)
//   f(z) = z sqrt(alpha / (2 l))                    for |z| <= l
//   f(z) = sgn(z) (sqrt(2 alpha |z|) - s)           beyond
// f and its slope are continuous; l -> 0 gives the law above; near the parent the damping ratio is
// sqrt(beta_c / (2 alpha)) >= 0.7; a parent that accelerates at its bound is followed at (beta_p / beta_c) l.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "agent/laws/minmax/pursuit_tree.h"
#include "agent/laws/parts/leader.h"
#include "agent/laws/parts/sgn.h"
#include "agent/laws/parts/waypoint_flight.h"
#include "experiment/experiment.h"

namespace mascot {
namespace {

constexpr auto kMinmaxParameters =
    Joined(Joined(kPursuitTreeParameters,
                  std::array{
                      key::Number("boundary_layer", {0, 1000},
                                  "distance to the parent within which sgn gives way to a smooth function")
                          .Default("0.0")
                          .Unit("m")
                          .Live(),
                  }),
           kLeaderFlightParameters);

struct MinmaxParams final : LawParams {
  PursuitForm tree;
  double boundary_layer_m = 0;
  std::optional<WaypointParams> root_flight;  ///< absent: the root's acceleration is 0
};

/// The law of every agent but the root: follows the parent on each axis by itself.
class Child final : public Law {
 public:
  explicit Child(const AgentConfig& agent) { Adopt(agent); }

  void Adopt(const AgentConfig& agent) override {
    const auto& params = ParamsOf<MinmaxParams>(agent.law);
    const auto i = static_cast<std::size_t>(agent.id - 1);
    parent_ = params.tree.parent[i];
    beta_ = params.tree.beta[i];
    alpha_ = beta_ - params.tree.parent_beta[i];
    layer_m_ = params.boundary_layer_m;
  }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const auto parent = std::find_if(heard.begin(), heard.end(), [this](const Heard& j) { return j.id == parent_; });
    if (parent == heard.end()) return Eigen::Vector3d::Zero();
    const Eigen::Vector3d z = self.p_WB - parent->motion.p_WB;
    const Eigen::Vector3d w = self.v_WB - parent->motion.v_WB;
    return {Accel(z.x(), w.x()), Accel(z.y(), w.y()), Accel(z.z(), w.z())};
  }

 private:
  double Accel(double z, double w) const {
    if (layer_m_ == 0) return -beta_ * Sgn(2 * alpha_ * z + w * std::abs(w));
    const double s = std::sqrt(alpha_ * layer_m_ / 2);
    const double f = std::abs(z) <= layer_m_ ? z * std::sqrt(alpha_ / (2 * layer_m_))
                                             : Sgn(z) * (std::sqrt(2 * alpha_ * std::abs(z)) - s);
    return -beta_ * std::clamp((w + f) / s, -1.0, 1.0);
  }

  int parent_ = 0;
  double beta_ = 0;
  double alpha_ = 0;
  double layer_m_ = 0;
};

/// The law of the root: keeps its velocity, or flies waypoints within its own bound, on which its children rely.
class Root final : public Law {
 public:
  explicit Root(const AgentConfig& agent) { Adopt(agent); }

  void Adopt(const AgentConfig& agent) override {
    const auto& params = ParamsOf<MinmaxParams>(agent.law);
    FlyAs(params.root_flight, agent, flight_);
    beta_ = params.tree.beta[static_cast<std::size_t>(agent.id - 1)];
  }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    if (!flight_) return Eigen::Vector3d::Zero();
    return flight_->Accel_W(t_s, self).cwiseMin(beta_).cwiseMax(-beta_);
  }

 private:
  std::optional<WaypointFlight> flight_;
  double beta_ = 0;
};

std::shared_ptr<const LawParams> ReadMinmax(const Experiment& experiment, const LawConfig& config, Section& law) {
  auto params = std::make_shared<MinmaxParams>();
  params->tree = ReadPursuitTree(experiment, config, law);
  params->boundary_layer_m = law.Number("boundary_layer");
  params->tree.switches = params->boundary_layer_m == 0;
  params->root_flight = ReadLeaderWaypoints(config, law);
  params->tree.root_flies = params->root_flight.has_value();
  return params;
}

std::unique_ptr<Law> MakeMinmax(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  const auto& params = ParamsOf<MinmaxParams>(agent.law);
  if (params.tree.parent[static_cast<std::size_t>(id - 1)] != 0) return std::make_unique<Child>(agent);
  return std::make_unique<Root>(agent);
}

const std::optional<WaypointParams>& FlightOfRoot(const LawConfig& law) {
  return ParamsOf<MinmaxParams>(law).root_flight;
}

PursuitForm PursuitOfMinmax(const LawConfig& law) { return ParamsOf<MinmaxParams>(law).tree; }

}  // namespace

LawEntry MinmaxLaw() {
  static constexpr std::string_view kPursuitPictures[] = {"disagreement", "tracking"};
  return {
      .name = "minmax",
      .summary = "min-max time consensus tracking on a spanning tree of the graph",
      .equation =
          "a_c = -beta_c sgn(2 (beta_c - beta_p) z + w |w|),  z = p_c - p_p,  w = v_c - v_p, per axis;  root: a = "
          "0, or its waypoints",
      .tex =
          R"(a_c = -\beta_c\, \mathrm{sgn}\bigl( 2 (\beta_c - \beta_p) z + w \lvert w \rvert \bigr), \quad z = p_c - p_p, \quad w = v_c - v_p \text{, per axis} \\
\text{root: } a = 0 \text{, or its waypoints})",
      .symbols = {{"beta", R"(\beta_c)"}},
      .graph = "a directed spanning tree rooted at the leader; each agent follows its parent in it",
      .details =
          "sgn(0) = 0. p is c's parent in a tree: the agent with the lowest number, of those that c hears, "
          "that is one step nearer to the root. beta_p is the parent's own beta, or with weak_edges = "
          "\"root\" the root's.\n"
          "A child that does not hear its parent at a tick wants the acceleration 0. The root's waypoints "
          "are flown within the root's own beta, per axis.\n"
          "With boundary_layer = l > 0: a_c = -beta_c sat((w + f(z)) / s), s = sqrt(alpha l / 2), alpha = "
          "beta_c - beta_p, where f(z) = z sqrt(alpha / (2 l)) for |z| <= l and sgn(z) (sqrt(2 alpha |z|) - "
          "s) beyond; sat is cut to -1..1 (Workman, Kosut & Franklin, ACC 1987).",
      .theory =
          "a child meets a resting parent after sqrt(2 z (1/alpha + 1/beta_c)), any parent within 2 sqrt(z / "
          "alpha), from rest, alpha = beta_c - beta_p > 0",
      .source = "Mulla et al. (2017): reference 19 of Pandit, Njattuvetty & Mulla, MASCOT (2022)",
      .parameters = kMinmaxParameters,
      .agrees = true,
      .gathers = true,
      .drawing = {.leader = "root", .switches = true, .pictures = kPursuitPictures, .telling = "tracking"},
      .read = ReadMinmax,
      .make = MakeMinmax,
      .go_to = GoToOf<FlightOfRoot>,
      .waypoints_W = LeaderWaypointsOf<FlightOfRoot>,
      .pursuit = PursuitOfMinmax};
}

}  // namespace mascot
