// Min-max time consensus: the time that each edge of the tree takes.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "agent/laws/parts/reach.h"
#include "orchestrator/theory/flight_envelope.h"
#include "orchestrator/theory/flown_pursuit.h"
#include "orchestrator/theory/lagged_pursuit.h"
#include "orchestrator/theory/minmax_time.h"
#include "orchestrator/theory/parts.h"

namespace mascot {
namespace {

/// The largest acceleration of the child along an axis (m/s^2).
double Strongest(const Experiment& experiment, const AgentConfig& child, double beta, int axis) {
  const double allowed = std::min(beta, child.control.max_acceleration_m_per_s2);
  const bool leans = child.traits().has_airframe && axis < 2;
  return leans ? std::min(allowed, LeanLimit(child, experiment.physics.gravity_m_per_s2)) : allowed;
}

/// How the child `edge.child` trembles: along x and y, for which it leans.
std::optional<Trembling> PredictTrembling(const Experiment& experiment, const MinmaxEdge& edge, double alpha,
                                          double beta) {
  const AgentConfig& child = experiment.agent(edge.child);
  const AgentConfig& parent = experiment.agent(edge.parent);
  Trembling trembling;
  trembling.lag_s = AccelerationLag(experiment, child, beta);
  trembling.radius_m = TrembleRadius(alpha, beta, trembling.lag_s);
  if (!std::isfinite(trembling.radius_m)) return std::nullopt;  // no proportional gain of the attitude: it never leans
  for (int axis = 0; axis < 2; ++axis) {
    const auto time_s = LaggedMinmaxTime(child.p_W[axis] - parent.p_W[axis], child.v_W[axis] - parent.v_W[axis], alpha,
                                         beta, trembling.lag_s, 2 * trembling.radius_m);
    if (!time_s) {
      trembling.time_s.reset();
      break;
    }
    trembling.time_s = std::max(*time_s, trembling.time_s.value_or(0));
  }
  return trembling;
}

/// The time of the slowest axis of the edge from `child` to its parent; nothing if there is no formula for it.
std::optional<MinmaxEdge> PredictEdge(const Experiment& experiment, const PursuitForm& law, int child) {
  const auto c = static_cast<std::size_t>(child - 1);
  const int parent = law.parent[c];
  const double alpha = law.beta[c] - law.parent_beta[c];
  const AgentConfig& agent = experiment.agent(child);
  const double strongest = Strongest(experiment, agent, law.beta[c], 0);
  const bool exact = parent == experiment.law.leader && !law.root_flies;
  // Limits may leave less than beta. If the parent does not accelerate, anything above alpha is enough.
  if (exact ? strongest <= alpha : strongest < law.beta[c]) return std::nullopt;

  MinmaxEdge edge{child, parent, 0, exact};
  if (exact && law.switches && agent.traits().has_airframe)
    edge.trembling = PredictTrembling(experiment, edge, alpha, strongest);
  const Eigen::Vector3d z_W = experiment.agent(child).p_W - experiment.agent(parent).p_W;
  const Eigen::Vector3d w_W = experiment.agent(child).v_W - experiment.agent(parent).v_W;
  for (int axis = 0; axis < CountOf(experiment.law.axes); ++axis) {
    edge.time_s = std::max(
        edge.time_s, exact ? MinmaxTime(z_W(axis), w_W(axis), alpha, Strongest(experiment, agent, law.beta[c], axis))
                           : MinmaxBound(z_W(axis), w_W(axis), alpha));
  }
  return edge;
}

void WarnOfCutBeta(const Experiment& experiment, const PursuitForm& law, Prediction& prediction) {
  std::vector<int> cut;
  double limit = 0;  // the largest limit of these agents
  for (const AgentConfig& agent : experiment.agents) {
    const bool idle = agent.id == experiment.law.leader && !law.root_flies;
    const double allowed = agent.control.max_acceleration_m_per_s2;
    if (idle || law.beta[static_cast<std::size_t>(agent.id - 1)] <= allowed) continue;
    cut.push_back(agent.id);
    limit = std::max(limit, allowed);
  }
  if (cut.empty()) return;
  prediction.warnings.push_back(
      fmt::format("law.beta: beta of {} is above control.max_acceleration_m_per_s2 = {:.4g}, which cuts it",
                  AgentList(cut), limit));
}

void WarnOfTrembling(Prediction& prediction) {
  std::vector<int> trembling;
  Trembling most;
  for (const MinmaxEdge& edge : prediction.minmax_edges) {
    if (!edge.trembling || 2 * edge.trembling->radius_m <= kCaughtUp_m) continue;
    trembling.push_back(edge.child);
    if (edge.trembling->radius_m > most.radius_m) most = *edge.trembling;
  }
  if (trembling.empty()) return;
  prediction.warnings.push_back(fmt::format(
      "law.beta: {} will tremble around the root by {}{:.2g} m, and may never stay within {:g} m of it: accelerations "
      "come {:.2g} s late, because the body turns first (agents.airframe); a smaller beta trembles less",
      AgentList(trembling), trembling.size() == 1 ? "about " : "up to ", most.radius_m, kCaughtUp_m, most.lag_s));
}

/// Takes back edges whose times do not hold because commands are held for a control period: the law is a relay, which
/// then overshoots, and a child may not stay near its parent, or come there later. Sets from when on the others are
/// together, and warns of those.
void JudgeHeldCommands(const Experiment& experiment, const PursuitForm& law, Prediction& prediction) {
  const auto is_ideal = [](const AgentConfig& agent) { return !agent.traits().has_airframe; };
  if (!experiment.sensors.own.IsNone() || !experiment.sensors.heard.IsNone()) return;  // noise does more
  if (prediction.minmax_edges.empty() || !std::ranges::all_of(experiment.agents, is_ideal)) return;
  double latest_s = 0;
  for (const MinmaxEdge& edge : prediction.minmax_edges) latest_s = std::max(latest_s, edge.time_s);
  const double h = experiment.period_s();
  const auto flown = FlyPursuit(experiment, 1.2 * latest_s + 200 * h);
  double together_s = 0;
  const auto holds = [&](const MinmaxEdge& edge) {
    const auto c = static_cast<std::size_t>(edge.child - 1);
    if (!flown)
      return 2 * TrembleRadius(law.beta[c] - law.parent_beta[c], law.beta[c], h) <= kCaughtUp_m || !law.switches;
    const auto of = std::ranges::find(*flown, edge.child, &PursuitMeter::Edge::child);
    if (!of->time_s || *of->time_s > edge.time_s + 2.5 * h) return false;
    together_s = std::max(together_s, *of->time_s);
    return true;
  };
  std::vector<int> late;
  for (const MinmaxEdge& edge : prediction.minmax_edges)
    if (!holds(edge)) late.push_back(edge.child);
  std::erase_if(prediction.minmax_edges,
                [&](const MinmaxEdge& edge) { return std::ranges::find(late, edge.child) != late.end(); });
  if (flown && !prediction.minmax_edges.empty()) prediction.holds_from = {together_s};
  if (late.empty()) return;
  const std::string who =
      fmt::format("{} will not be with {} parent within {:g} m for good in the time of the closed form",
                  AgentList(late), late.size() == 1 ? "its" : "their", kCaughtUp_m);
  prediction.warnings.push_back(
      law.switches
          ? fmt::format("control.rate_hz: {}, because commands are held for {:.4g} s; a higher rate, a smaller "
                        "beta or law.boundary_layer does it",
                        who, h)
          : fmt::format("law.boundary_layer: {}, because the last of the way is flown gently", who));
}

/// From when on the edges' times hold, where no flight has said so.
std::optional<HoldsFrom> WhenCaughtUp(const Experiment& experiment, const std::vector<MinmaxEdge>& edges) {
  HoldsFrom exact, bound{0, Bound::kAtMost};
  for (const MinmaxEdge& edge : edges) {
    double& time_s = edge.exact ? exact.time_s : bound.time_s;
    time_s = std::max(time_s, edge.time_s);
  }
  if (edges.empty()) return std::nullopt;
  return exact.time_s > experiment.run.duration_s || exact.time_s >= bound.time_s ? exact : bound;
}

void WarnOfWeakEdges(const PursuitForm& law, Prediction& prediction) {
  std::vector<int> weak;
  for (std::size_t i = 0; i < law.parent.size(); ++i) {
    if (law.parent[i] != 0 && law.beta[i] <= law.beta[static_cast<std::size_t>(law.parent[i] - 1)])
      weak.push_back(static_cast<int>(i) + 1);
  }
  if (weak.empty()) return;
  prediction.warnings.push_back(
      fmt::format("law.weak_edges: {} {} no stronger than the parent, who must keep within the root's bound",
                  AgentList(weak), weak.size() == 1 ? "is" : "are"));
}

/// The meeting point, if the root is at rest: its position; with axes "xy", z is the mean of the heights that are held.
std::optional<Eigen::Vector3d> RestingRoot(const Experiment& experiment, const PursuitForm& law) {
  const AgentConfig& root = experiment.agent(experiment.law.leader);
  if (law.root_flies || !root.v_W.head(CountOf(experiment.law.axes)).isZero(0)) return std::nullopt;
  Eigen::Vector3d value_m = root.p_W;
  if (experiment.law.axes == Axes::kXyz) return value_m;
  value_m.z() = 0;
  for (const AgentConfig& agent : experiment.agents) value_m.z() += agent.p_W.z() / experiment.size();
  return value_m;
}

/// Why the closed forms do not hold; empty: they do. They assume that children receive the current state of their
/// parents at every tick.
std::string WhyNot(const Experiment& experiment, const Timeline& timeline) {
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.has_own_law) return fmt::format("agents.override: agent {} has a law of its own", agent.id);
    if (agent.traits().rolls) return fmt::format("agent {} is a unicycle, which turns before it goes", agent.id);
  }
  if (!timeline.IsConstant()) return "the graph changes, and a child that does not hear its parent drifts";
  if (experiment.schedule.range_m() > 0) return "graph.range_m: a child that does not hear its parent drifts";
  if (!experiment.links.ArePerfect(experiment.graph)) return "link: children see their parents late, or not always";
  if (experiment.sensors.own_delay_s > 0) return "sensors.own.delay_s: agents know late where they are";
  return "";
}

}  // namespace

void PredictPursuit(const Experiment& experiment, const Timeline& timeline, const PursuitForm& law,
                    Prediction& prediction) {
  prediction.silent = WhyNot(experiment, timeline);
  if (prediction.silent.empty()) {
    prediction.value_m = RestingRoot(experiment, law);
    for (const AgentConfig& agent : experiment.agents) {
      if (agent.id == experiment.law.leader) continue;
      if (const auto edge = PredictEdge(experiment, law, agent.id)) prediction.minmax_edges.push_back(*edge);
    }
  }
  if (prediction.silent.empty() && prediction.minmax_edges.empty() && experiment.size() > 1)
    (prediction.value_m ? prediction.figures_silent : prediction.silent) =
        "limits leave no child the acceleration that it takes to catch up";
  JudgeHeldCommands(experiment, law, prediction);
  if (!prediction.holds_from) prediction.holds_from = WhenCaughtUp(experiment, prediction.minmax_edges);
  for (const MinmaxEdge& edge : prediction.minmax_edges) {
    prediction.minmax_time_s = std::max(edge.time_s, prediction.minmax_time_s.value_or(0));
  }
  WarnOfCutBeta(experiment, law, prediction);
  WarnOfTrembling(prediction);
  WarnOfWeakEdges(law, prediction);
}

}  // namespace mascot
