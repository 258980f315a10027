#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/modes.h"

namespace mascot {

/// Dynamics of one agent whose law and model together are linear in q = p - d, where d is the agent's place in a
/// formation, or 0 without a formation:
///   order 1:  v_i = p sum_j a_ij (q_j - q_i)
///   order 2:  dv_i/dt = sum_j a_ij [p (q_j - q_i) + g (v_j - v_i)] - b v_i
/// A law that wants a velocity, on a model driven by acceleration, gives order 2 with k_v p in place of p, and b = k_v.
struct LinearAgent {
  int order = 2;
  double hold = 0.5;    ///< for order 2: see LinearMode::hold
  double p = 0;         ///< 1/s^2; for order 1: 1/s
  double g = 0;         ///< 1/s
  double b = 0;         ///< damping (1/s), with uncompensated drag
  bool listens = true;  ///< false: the agent is a leader
  bool flies = false;   ///< a leader that flies along waypoints
  double off_b = 0;     ///< for order 2: damping while its law is off (1/s)
  double drag_b = 0;    ///< the part of b that is drag (1/s)

  bool MovesAs(const LinearAgent& other) const {
    return order == other.order && hold == other.hold && p == other.p && g == other.g && b == other.b;
  }
  LinearMode Mode(std::complex<double> lambda) const { return {b + g * lambda, p * lambda, order, hold}; }
};

/// The agents of an experiment as linear dynamics.
struct LinearTeam {
  std::vector<LinearAgent> agents;       ///< by id - 1
  std::vector<Eigen::Vector3d> place_W;  ///< d_i, by id - 1 (m)

  const LinearAgent& agent(int id) const { return agents[static_cast<std::size_t>(id - 1)]; }
  /// Indices (id - 1) of the agents that are not leaders.
  std::vector<Eigen::Index> Listening() const;
  /// Ids of the leaders.
  std::vector<int> Leaders() const;
  /// The dynamics that all agents but the leaders have in common; nothing if they differ, or if all are leaders.
  std::optional<LinearAgent> Common() const;
  /// `graph` without the edges on which leaders hear, because leaders use nothing of what they hear.
  Graph Followed(const Graph& graph) const;
};

/// The experiment as a linear team, or the reason why it is not linear.
struct Linearity {
  std::optional<LinearTeam> team;
  std::string why_not;
};

Linearity LinearTeamOf(const Experiment& experiment);
/// Why theory says nothing of a law: it has no model of it.
std::string WhyUnknown(const LawConfig& law);
/// Dynamics of an agent that is not a leader, under a law of this form, whose output is `wanted`.
LinearAgent FollowingAgent(const AgentConfig& agent, const LinearForm& form, Wanted wanted);
/// Dynamics of an agent that flies to its target by itself, under a law of this form that does not listen.
LinearAgent FlyingAgent(const AgentConfig& agent, const LinearForm& form);

}  // namespace mascot
