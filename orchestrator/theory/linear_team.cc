#include "orchestrator/theory/linear_team.h"

#include <algorithm>

#include "agent/laws/laws.h"
#include "agent/laws/parts/reach.h"

namespace mascot {
namespace {

/// Uncompensated linear drag per mass (1/s).
double Drag(const AgentConfig& agent) {
  if (!agent.traits().has_airframe || agent.control.drag_compensation) return 0;
  return agent.airframe.linear_drag_kg_per_s / agent.airframe.mass_kg;
}

/// Dynamics of the agent's model under a law of this form, whose output is `wanted`.
LinearAgent Driven(const AgentConfig& agent, const LinearForm& form, Wanted wanted) {
  const bool by_velocity = agent.traits().driven_by == Wanted::kVelocity;
  LinearAgent linear{.p = form.p, .g = form.g, .b = form.beta};
  if (by_velocity) {
    linear.order = wanted == Wanted::kVelocity ? 1 : 2;
    linear.hold = 1;
    return linear;
  }
  const double k_v = agent.control.velocity_gain;
  if (wanted == Wanted::kVelocity) linear.p = k_v * form.p, linear.b = k_v;
  linear.drag_b = Drag(agent);
  linear.b += linear.drag_b;
  linear.off_b = k_v + linear.drag_b;
  return linear;
}

/// Dynamics of a leader: no coupling and, except for drag, no damping; but a leader whose law wants the velocity 0
/// slows down with the velocity gain.
LinearAgent Leading(LinearAgent agent, bool flies, Wanted wanted) {
  agent.p = agent.g = 0;
  agent.listens = false;
  agent.flies = flies;
  if (wanted == Wanted::kAcceleration) agent.b = agent.drag_b;
  return agent;
}

/// Why unicycles make the team nonlinear; empty: there are none.
std::string Unicycles(const Experiment& experiment) {
  std::vector<int> ids;
  for (const AgentConfig& agent : experiment.agents)
    if (agent.traits().rolls) ids.push_back(agent.id);
  if (ids.empty()) return "";
  return AgentList(ids) + (ids.size() == 1 ? " is a unicycle, which turns" : " are unicycles, which turn") +
         " before going where wanted";
}

/// Why theory does not apply to the law of an agent; empty: all laws are linear.
std::string UnknownLaw(const Experiment& experiment) {
  for (const AgentConfig& agent : experiment.agents)
    if (!LinearFormOf(agent.law)) return WhyUnknown(agent.law) + " (agent " + std::to_string(agent.id) + ")";
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

LinearAgent FollowingAgent(const AgentConfig& agent, const LinearForm& form, Wanted wanted) {
  return Driven(agent, form, wanted);
}

LinearAgent FlyingAgent(const AgentConfig& agent, const LinearForm& form) {
  return Driven(agent, form, Wanted::kAcceleration);
}

std::string WhyUnknown(const LawConfig& law) {
  return "the law " + law.name +
         (EntryOf(law).is_of_user ? " is code of a user, of which theory has no model"
                                  : " is one of which theory has no model");
}

Linearity LinearTeamOf(const Experiment& experiment) {
  for (std::string why_not : {Unicycles(experiment), UnknownLaw(experiment)})
    if (!why_not.empty()) return {std::nullopt, std::move(why_not)};
  LinearTeam team;
  const std::vector<Eigen::Vector3d> nowhere(experiment.agents.size(), Eigen::Vector3d::Zero());
  for (const AgentConfig& agent : experiment.agents) {
    const LinearForm form = *LinearFormOf(agent.law);
    if (!form.listens) {
      const Wanted wanted = Wanted::kAcceleration;
      team.agents.push_back(Leading(Driven(agent, {}, wanted), form.leader_flies, wanted));
      continue;
    }
    const Wanted wanted = WantedBy(agent.law);
    const LinearAgent driven = Driven(agent, form, wanted);
    team.agents.push_back(agent.id == agent.law.leader ? Leading(driven, form.leader_flies, wanted) : driven);
    std::span<const Eigen::Vector3d> place_W = PlacesOf(agent.law);
    if (place_W.empty()) place_W = nowhere;
    if (team.place_W.empty()) team.place_W.assign(place_W.begin(), place_W.end());
    if (!std::ranges::equal(team.place_W, place_W)) return {std::nullopt, "agents keep different formations"};
  }
  if (team.place_W.empty()) team.place_W = nowhere;
  return {std::move(team), ""};
}

}  // namespace mascot
