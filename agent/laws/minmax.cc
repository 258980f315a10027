// Min-max time consensus tracking, Mulla et al. (2017), on a directed spanning tree. Per axis, child c of
// parent p, with z = p_c - p_p, w = v_c - v_p and alpha = beta_c - beta_p > 0:
//   a_c = -beta_c sgn(2 alpha z + w |w|),  sgn(0) = 0
// It meets the parent in the least time that no motion of the parent within its bound beta_p can prolong.
//
// With a boundary layer l > 0 the switching curve gets a linear piece and sgn a linear zone, as in the proximate
// time-optimal servomechanism of Workman, Kosut & Franklin (ACC 1987):
//   a_c = -beta_c sat((w + f(z)) / s),   s = sqrt(alpha l / 2)
//   f(z) = z sqrt(alpha / (2 l))                    for |z| <= l
//   f(z) = sgn(z) (sqrt(2 alpha |z|) - s)           beyond
// f and its slope are continuous; l -> 0 gives the law above; near the parent the damping ratio is
// sqrt(beta_c / (2 alpha)) >= 0.7; a parent that accelerates at its bound is followed at (beta_p / beta_c) l.
#include "agent/laws/minmax.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "agent/laws/reach.h"

namespace mascot {
namespace {

double Sign(double x) { return (x > 0) - (x < 0); }

/// Follows the parent on every axis.
class Child final : public Law {
 public:
  Child(int parent, double beta, double parent_beta, double boundary_layer_m)
      : parent_(parent), beta_(beta), alpha_(beta - parent_beta), layer_m_(boundary_layer_m) {}

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

  int parent_;
  double beta_;
  double alpha_;
  double layer_m_;
};

/// Follows nobody: keeps its velocity, or flies waypoints within the bound that its children count on.
class Root final : public Law {
 public:
  Root(std::optional<WaypointFlight> flight, double beta) : flight_(std::move(flight)), beta_(beta) {}

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> /*heard*/) override {
    if (!flight_) return Eigen::Vector3d::Zero();
    return flight_->Accel_W(t_s, self).cwiseMin(beta_).cwiseMax(-beta_);
  }

 private:
  std::optional<WaypointFlight> flight_;
  double beta_;
};

/// One bound per agent, whatever the file says.
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

/// Parents by id - 1, all 0 where there is no tree to follow.
std::vector<int> ReadTree(const Experiment& experiment, LawConfig& law) {
  const std::vector<int> nobody(static_cast<std::size_t>(experiment.size()), 0);
  const int root = law.leader;
  // A graph or a leader that was refused already is not worth a second complaint.
  if (law.section.Wrong("leader") || experiment.graph.size() != experiment.size()) return nobody;
  if (root == 0) {
    law.section.Fail("leader", "expected the root of the tree in 1..N, got 0");
    return nobody;
  }
  if (const auto tree = experiment.graph.SpanningTree(root)) return *tree;
  law.section.Fail("leader", "expected a root whom everyone hears, directly or not, got " + std::to_string(root) +
                                 ", who does not reach " + AgentList(NotReached(experiment.graph, root)));
  return nobody;
}

/// beta_c > beta_p on every edge, or the law promises nothing.
void CheckEdges(LawConfig& law, const MinmaxParams& params, bool root_bound) {
  std::string first;
  int others = 0;
  for (std::size_t i = 0; i < params.parent.size(); ++i) {
    if (params.parent[i] == 0 || params.beta[i] > params.parent_beta[i]) continue;
    if (!first.empty()) {
      ++others;
      continue;
    }
    const std::string child = std::to_string(i + 1);
    const std::string parent = std::to_string(params.parent[i]);
    const std::string bound_of = root_bound ? "the root " + std::to_string(law.leader) : "its parent " + parent;
    first = "expected beta of agent " + child + " above that of " + bound_of + " (edge " + child + " -> " + parent +
            "), got " + ShortestFloat(params.beta[i]) + " and " + ShortestFloat(params.parent_beta[i]);
  }
  if (first.empty()) return;
  if (others > 0) first += " (and " + std::to_string(others) + (others == 1 ? " more edge)" : " more edges)");
  law.section.Fail("beta", first);
}

}  // namespace

MinmaxParams ReadMinmax(const Experiment& experiment, LawConfig& config) {
  Section& law = config.section;
  MinmaxParams params;
  params.parent = ReadTree(experiment, config);
  params.beta = ReadBeta(law, experiment.size());
  const bool root_bound = law.OneOf("weak_edges") == "root";
  params.boundary_layer_m = law.Number("boundary_layer");
  params.root_flight = ReadLeaderWaypoints(config);

  params.parent_beta.resize(params.beta.size(), 0.0);
  for (std::size_t i = 0; i < params.parent.size(); ++i) {
    if (params.parent[i] == 0) continue;
    const int bound_of = root_bound ? config.leader : params.parent[i];
    params.parent_beta[i] = params.beta[static_cast<std::size_t>(bound_of - 1)];
  }
  if (!law.Wrong("beta")) CheckEdges(config, params, root_bound);
  return params;
}

bool CheckMinmax(Experiment& experiment, LawConfig& law) {
  ReadMinmax(experiment, law);
  return false;
}

std::unique_ptr<Law> MakeMinmax(Experiment& experiment, int id) {
  LawConfig law = experiment.agent(id).law;
  const MinmaxParams params = ReadMinmax(experiment, law);
  const auto i = static_cast<std::size_t>(id - 1);
  if (params.parent[i] != 0) {
    return std::make_unique<Child>(params.parent[i], params.beta[i], params.parent_beta[i], params.boundary_layer_m);
  }
  std::optional<WaypointFlight> flight;
  if (params.root_flight) flight.emplace(*params.root_flight, law.axes, experiment.agent(id).p_W);
  return std::make_unique<Root>(std::move(flight), params.beta[i]);
}

}  // namespace mascot
