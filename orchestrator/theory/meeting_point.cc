// The meeting point c follows from a conserved quantity. Order 2, neighbours heard with delay tau (nothing before tau),
// own state known without delay: integrate
//   dv_i/dt = sum_j a_ij [p_i (q_j(t - tau) - q_i) + g_i (v_j(t - tau) - v_i)] - b_i v_i
// over all time, with q_i -> c and v_i -> 0, and add the equations with weights gamma_i / p_i, where gamma is the left
// null vector of L. The integrals of q drop out, and with d_i = sum_j a_ij there remains
//   sum_i gamma_i / p_i { (b_i + p_i d_i tau) (q_i(0) - c) + v_i(0) + g_i sum_j a_ij (q_i(0) - q_j(0)) } = 0
// Order 1: the same with b_i = 1, g_i = 0 and without v_i(0), since the law sets the velocity. tau is the delay in
// whole ticks. v_i(0) != 0 is allowed for tau = 0 only: otherwise agents move before they hear anything.
#include "orchestrator/theory/meeting_point.h"

#include <algorithm>

#include "orchestrator/theory/links_on_average.h"

namespace mascot {
namespace {

/// The common delay of all edges, in whole ticks (s); nothing if delays differ, or if own states are measured with
/// delay.
std::optional<double> CommonDelay(const Experiment& experiment, const Graph& graph) {
  const std::optional<std::int64_t> ticks = CommonDelayTicks(experiment, graph);
  if (!ticks || experiment.sensors.own_delay_s > 0) return std::nullopt;
  return experiment.time_s(*ticks);
}

bool AreAtRest(const Experiment& experiment) {
  return std::ranges::all_of(experiment.agents, [](const AgentConfig& agent) { return agent.v_W.isZero(0); });
}

/// q_i(0) of agent `id`.
Eigen::Vector3d Start(const Experiment& experiment, const LinearTeam& team, int id) {
  return experiment.agent(id).p_W - team.place_W[static_cast<std::size_t>(id - 1)];
}

}  // namespace

std::optional<Eigen::Vector3d> MeetingPoint(const Experiment& experiment, const LinearTeam& team, const Graph& graph) {
  const std::optional<Eigen::VectorXd> gamma = graph.LeftNullVector();
  const std::optional<double> tau_s = CommonDelay(experiment, graph);
  const bool at_rest = AreAtRest(experiment);
  if (!gamma || !tau_s || (*tau_s > 0 && !at_rest)) return std::nullopt;

  double weights = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  // Without damping and delay, a team that starts from rest keeps the mean weighted by gamma.
  const bool coast = at_rest && *tau_s == 0 && team.Common() && team.Common()->order == 2 && team.Common()->b == 0;
  for (const AgentConfig& agent : experiment.agents) {
    const LinearAgent& moves = team.agent(agent.id);
    const Eigen::Vector3d q = Start(experiment, team, agent.id);
    double degree = 0;
    Eigen::Vector3d away = Eigen::Vector3d::Zero();
    for (const Graph::Neighbour& heard : graph.HeardBy(agent.id)) {
      degree += heard.weight;
      away += heard.weight * (q - Start(experiment, team, heard.id));
    }
    const double brakes = moves.order == 1 || coast ? 1 : moves.b;
    const double share = (*gamma)(agent.id - 1) / moves.p;
    weights += share * (brakes + moves.p * degree * *tau_s);
    sum += share * ((brakes + moves.p * degree * *tau_s) * q + moves.g * away);
    if (moves.order == 2) sum += share * agent.v_W;
  }
  if (weights == 0) return std::nullopt;
  return sum / weights;
}

std::optional<Eigen::Vector3d> RestingPlace(const Experiment& experiment, const LinearTeam& team, int leader) {
  const LinearAgent& moves = team.agent(leader);
  const AgentConfig& agent = experiment.agent(leader);
  const Eigen::Vector3d q = Start(experiment, team, leader);
  const Eigen::Index axes = CountOf(experiment.law.axes);
  if (moves.flies) return std::nullopt;
  if (moves.order == 1 || agent.v_W.head(axes).isZero(0)) return q;
  if (moves.b == 0) return std::nullopt;
  return q + agent.v_W / moves.b;
}

double HeldHeight(const Experiment& experiment, const LinearTeam& team) {
  double sum_m = 0;
  for (const AgentConfig& agent : experiment.agents) sum_m += Start(experiment, team, agent.id).z();
  return sum_m / experiment.size();
}

}  // namespace mascot
