#include "orchestrator/theory/linear_team.h"

#include <algorithm>

#include "agent/controller.h"
#include "agent/laws/consensus.h"
#include "agent/laws/formation.h"
#include "agent/laws/reach.h"
#include "agent/laws/velocity_consensus.h"

namespace mascot {
namespace {

/// What a law contributes: its gains, and what it wants.
struct LinearLaw {
  Wanted wanted = Wanted::kAcceleration;
  double p = 0;
  double g = 0;
  double beta = 0;
  bool leader_flies = false;
  std::vector<Eigen::Vector3d> place_W = {};  // by id - 1; empty: all zero
};

LinearLaw ReadLaw(const Experiment& experiment, LawConfig law) {
  if (law.name == "velocity_consensus") return {.wanted = Wanted::kVelocity, .p = ReadVelocityConsensus(law)};
  if (law.name == "formation") {
    FormationParams params = ReadFormation(experiment, law);
    return {.p = params.p_gain,
            .g = params.v_gain,
            .beta = params.beta,
            .leader_flies = params.leader_flight.has_value(),
            .place_W = std::move(params.d_W)};
  }
  const ConsensusParams params = ReadConsensus(law);
  return {
      .p = params.p_gain, .g = params.v_gain, .beta = params.beta, .leader_flies = params.leader_flight.has_value()};
}

bool IsLinear(const std::string& law) {
  return law == "consensus" || law == "formation" || law == "velocity_consensus";
}

double Drag(const AgentConfig& agent) {
  if (agent.model != "quadrotor" || agent.control.drag_compensation) return 0;
  return agent.airframe.linear_drag_kg_per_s / agent.airframe.mass_kg;
}

/// How the agent's model does what a law with these gains wants.
LinearAgent Driven(const AgentConfig& agent, const LinearLaw& law) {
  const bool by_velocity = DrivenBy(agent.model) == Wanted::kVelocity;
  LinearAgent linear{.p = law.p, .g = law.g, .b = law.beta};
  if (by_velocity) {
    linear.order = law.wanted == Wanted::kVelocity ? 1 : 2;
    linear.hold = 1;
    return linear;
  }
  const double k_v = agent.control.velocity_gain;
  if (law.wanted == Wanted::kVelocity) linear.p = k_v * law.p, linear.b = k_v;
  linear.drag_b = Drag(agent);
  linear.b += linear.drag_b;
  linear.off_b = k_v + linear.drag_b;
  return linear;
}

/// A leader does not brake, unless it stands still by wanting the velocity 0.
LinearAgent Leading(LinearAgent agent, const LinearLaw& law) {
  agent.p = agent.g = 0;
  agent.listens = false;
  agent.flies = law.leader_flies;
  if (law.wanted == Wanted::kAcceleration) agent.b = agent.drag_b;
  return agent;
}

std::string Unicycles(const Experiment& experiment) {
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents)
    if (agent.model == "unicycle") ids.push_back(agent.id);
  if (ids.empty()) return "";
  return AgentList(ids) + (ids.size() == 1 ? " is a unicycle, which turns" : " are unicycles, which turn") +
         " before going where wanted";
}

std::string StrangeLaw(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents)
    if (!IsLinear(agent.law.name) && agent.law.name != "waypoint")
      return "theory does not know the law " + agent.law.name + " of agent " + std::to_string(agent.id);
  return "";
}

}  // namespace

std::vector<Eigen::Index> LinearTeam::Listening() const {
  std::vector<Eigen::Index> listening;
  for (std::size_t i = 0; i < agents.size(); ++i)
    if (agents[i].listens) listening.push_back(static_cast<Eigen::Index>(i));
  return listening;
}

std::vector<int> LinearTeam::Leaders() const {
  std::vector<int> ids;
  for (std::size_t i = 0; i < agents.size(); ++i)
    if (!agents[i].listens) ids.push_back(static_cast<int>(i) + 1);
  return ids;
}

std::optional<LinearAgent> LinearTeam::Common() const {
  const auto first = std::ranges::find_if(agents, &LinearAgent::listens);
  if (first == agents.end()) return std::nullopt;
  for (const LinearAgent& agent : agents)
    if (agent.listens && !agent.MovesAs(*first)) return std::nullopt;
  return *first;
}

Graph LinearTeam::Followed(const Graph& graph) const {
  std::vector<std::vector<Graph::Neighbour>> heard(agents.size());
  for (const Eigen::Index i : Listening()) heard[static_cast<std::size_t>(i)] = graph.HeardBy(static_cast<int>(i) + 1);
  return Graph(std::move(heard));
}

LinearAgent WaypointAgent(const AgentConfig& agent, double p_gain, double d_gain) {
  return Driven(agent, {.p = p_gain, .beta = d_gain});
}

Linearity LinearTeamOf(const Experiment& experiment) {
  for (std::string why_not : {Unicycles(experiment), StrangeLaw(experiment)})
    if (!why_not.empty()) return {std::nullopt, std::move(why_not)};
  LinearTeam team;
  const std::vector<Eigen::Vector3d> nowhere(experiment.agents.size(), Eigen::Vector3d::Zero());
  std::optional<LinearLaw> common;  // of all without a law of their own
  for (const AgentConfig& agent : experiment.agents) {
    if (agent.law.name == "waypoint") {
      team.agents.push_back(Leading(Driven(agent, {}), {.leader_flies = true}));
      continue;
    }
    if (!agent.has_own_law && !common) common = ReadLaw(experiment, agent.law);
    const LinearLaw law = agent.has_own_law ? ReadLaw(experiment, agent.law) : *common;
    const LinearAgent driven = Driven(agent, law);
    team.agents.push_back(agent.id == agent.law.leader ? Leading(driven, law) : driven);
    const auto& place_W = law.place_W.empty() ? nowhere : law.place_W;
    if (team.place_W.empty()) team.place_W = place_W;
    if (team.place_W != place_W) return {std::nullopt, "agents keep different formations"};
  }
  if (team.place_W.empty()) team.place_W = nowhere;
  return {std::move(team), ""};
}

}  // namespace mascot
