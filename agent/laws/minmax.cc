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
#include <utility>
#include <vector>

#include "agent/laws/leader.h"
#include "agent/laws/reach.h"
#include "agent/laws/waypoint_flight.h"
#include "experiment/experiment.h"

namespace mascot {
namespace {

constexpr std::string_view kWeakEdges[] = {"refuse", "root"};

constexpr auto kMinmaxParameters = Joined(
    std::array{
        key::Integer("leader", 1, kMaxAgents, "root of the spanning tree, 1..N").Required(),
        key::Number("beta", Above(0, 1000), "largest acceleration per axis: one number, or a list by id")
            .Or(ValueKind::kNumbers)
            .Unit("m/s^2")
            .Required()
            .Live(),
        key::OneOf("weak_edges", kWeakEdges,
                   "an edge whose child is not stronger than its parent: refuse, or expect the root's bound of every "
                   "parent")
            .Default("\"refuse\""),
        key::Number("boundary_layer", {0, 1000},
                    "distance to the parent within which sgn gives way to a smooth function")
            .Default("0.0")
            .Unit("m")
            .Live(),
    },
    kLeaderFlightParameters);

struct MinmaxParams final : LawParams {
  PursuitForm tree;
  double boundary_layer_m = 0;
  std::optional<WaypointParams> root_flight;  ///< absent: the root's acceleration is 0
};

double Sign(double x) { return (x > 0) - (x < 0); }

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
    if (layer_m_ == 0) return -beta_ * Sign(2 * alpha_ * z + w * std::abs(w));
    const double s = std::sqrt(alpha_ * layer_m_ / 2);
    const double f = std::abs(z) <= layer_m_ ? z * std::sqrt(alpha_ / (2 * layer_m_))
                                             : Sign(z) * (std::sqrt(2 * alpha_ * std::abs(z)) - s);
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

/// law.beta as one bound per agent (m/s^2), also after a mistake.
std::vector<double> ReadBeta(Section& law, int agents) {
  const auto count = static_cast<std::size_t>(agents);
  if (law.Kind("beta") != "list") return std::vector<double>(count, law.Number("beta"));
  std::vector<double> beta = law.Numbers("beta");
  if (beta.size() != count && !law.Wrong("beta")) {
    law.Fail("beta",
             "expected " + std::to_string(count) + " numbers, one per agent, got " + std::to_string(beta.size()));
  }
  beta.resize(count, 1.0);
  return beta;
}

/// Each agent's parent, by id - 1; all 0 if there is no tree.
std::vector<int> ReadTree(const Experiment& experiment, int root, Section& law) {
  const std::vector<int> nobody(static_cast<std::size_t>(experiment.size()), 0);
  // A mistake in the graph or the leader has been noted already.
  if (law.Wrong("leader") || experiment.graph.size() != experiment.size()) return nobody;
  if (root == 0) {
    law.Fail("leader", "expected the root of the tree in 1..N, got 0");
    return nobody;
  }
  if (const auto tree = experiment.graph.SpanningTree(root)) return *tree;
  law.Fail("leader", "expected a root whom everyone hears, directly or not, got " + std::to_string(root) +
                         ", who does not reach " + AgentList(NotReached(experiment.graph, root)));
  return nobody;
}

/// Checks beta_c > beta_p on every edge, without which the law promises nothing.
void CheckEdges(const PursuitForm& tree, int root, bool root_bound, Section& law) {
  std::string first;
  int others = 0;
  for (std::size_t i = 0; i < tree.parent.size(); ++i) {
    if (tree.parent[i] == 0 || tree.beta[i] > tree.parent_beta[i]) continue;
    if (!first.empty()) {
      ++others;
      continue;
    }
    const std::string child = std::to_string(i + 1);
    const std::string parent = std::to_string(tree.parent[i]);
    const std::string bound_of = root_bound ? "the root " + std::to_string(root) : "its parent " + parent;
    first = "expected beta of agent " + child + " above that of " + bound_of + " (edge " + child + " -> " + parent +
            "), got " + ShortestFloat(tree.beta[i]) + " and " + ShortestFloat(tree.parent_beta[i]);
  }
  if (first.empty()) return;
  if (others > 0) first += " (and " + std::to_string(others) + (others == 1 ? " more edge)" : " more edges)");
  law.Fail("beta", first);
}

std::shared_ptr<const LawParams> ReadMinmax(const Experiment& experiment, const LawConfig& config, Section& law) {
  auto params = std::make_shared<MinmaxParams>();
  PursuitForm& tree = params->tree;
  tree.parent = ReadTree(experiment, config.leader, law);
  tree.beta = ReadBeta(law, experiment.size());
  const bool root_bound = law.OneOf("weak_edges") == "root";
  params->boundary_layer_m = law.Number("boundary_layer");
  tree.switches = params->boundary_layer_m == 0;
  params->root_flight = ReadLeaderWaypoints(config, law);
  tree.root_flies = params->root_flight.has_value();

  tree.parent_beta.resize(tree.beta.size(), 0.0);
  for (std::size_t i = 0; i < tree.parent.size(); ++i) {
    if (tree.parent[i] == 0) continue;
    const int bound_of = root_bound ? config.leader : tree.parent[i];
    tree.parent_beta[i] = tree.beta[static_cast<std::size_t>(bound_of - 1)];
  }
  if (!law.Wrong("beta")) CheckEdges(tree, config.leader, root_bound, law);
  return params;
}

std::unique_ptr<Law> MakeMinmax(const Experiment& experiment, int id) {
  const AgentConfig& agent = experiment.agent(id);
  const auto& params = ParamsOf<MinmaxParams>(agent.law);
  if (params.tree.parent[static_cast<std::size_t>(id - 1)] != 0) return std::make_unique<Child>(agent);
  return std::make_unique<Root>(agent);
}

std::map<std::string, Value> GoToOfMinmax(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s) {
  const auto flight_of = [](const LawConfig& law) -> const std::optional<WaypointParams>& {
    return ParamsOf<MinmaxParams>(law).root_flight;
  };
  return GoToOfLeader(flight_of, agent, p_W, t_s);
}

std::span<const Eigen::Vector3d> WaypointsOfMinmax(const LawConfig& law) {
  return WaypointsOf(ParamsOf<MinmaxParams>(law).root_flight);
}

PursuitForm PursuitOfMinmax(const LawConfig& law) { return ParamsOf<MinmaxParams>(law).tree; }

}  // namespace

LawEntry MinmaxLaw() {
  static constexpr std::string_view kPursuitPictures[] = {"disagreement", "tracking"};
  return {.name = "minmax",
          .summary = "min-max time consensus tracking on a spanning tree of the graph",
          .equation =
              "a_c = -beta_c sgn(2 (beta_c - beta_p) z + w |w|),  z = p_c - p_p,  w = v_c - v_p, per axis;  root: a = "
              "0, or its waypoints",
          .theory =
              "a child meets a resting parent after sqrt(2 z (1/alpha + 1/beta_c)), any parent within 2 sqrt(z / "
              "alpha), from rest, alpha = beta_c - beta_p > 0",
          .source = "Mulla et al. (2017)",
          .parameters = kMinmaxParameters,
          .agrees = true,
          .gathers = true,
          .drawing = {.leader = "root", .switches = true, .pictures = kPursuitPictures},
          .read = ReadMinmax,
          .make = MakeMinmax,
          .go_to = GoToOfMinmax,
          .waypoints_W = WaypointsOfMinmax,
          .pursuit = PursuitOfMinmax};
}

}  // namespace mascot
