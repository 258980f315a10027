#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/modes.h"

namespace mascot {

/// One agent, if law and model together are linear in q = p - d, d being its place in a formation, else 0:
///   order 1:  v_i = p sum_j a_ij (q_j - q_i)
///   order 2:  dv_i/dt = sum_j a_ij [p (q_j - q_i) + g (v_j - v_i)] - b v_i
/// A law that wants a velocity of a model driven by acceleration is of order 2: p and b are k_v p and k_v.
struct LinearAgent {
  int order = 2;
  double hold = 0.5;  ///< of order 2, as LinearMode has it
  double p = 0;
  double g = 0;
  double b = 0;         ///< with the drag that nobody compensates
  bool listens = true;  ///< false: it leads
  bool flies = false;   ///< of one that leads: along waypoints
  double off_b = 0;     ///< of order 2: what brakes it while its law is off
  double drag_b = 0;    ///< the part of b that is drag

  bool MovesAs(const LinearAgent& other) const {
    return order == other.order && hold == other.hold && p == other.p && g == other.g && b == other.b;
  }
  LinearMode Mode(std::complex<double> lambda) const { return {b + g * lambda, p * lambda, order, hold}; }
};

struct LinearTeam {
  std::vector<LinearAgent> agents;       ///< by id - 1
  std::vector<Eigen::Vector3d> place_W;  ///< d, likewise

  const LinearAgent& agent(int id) const { return agents[static_cast<std::size_t>(id - 1)]; }
  /// Of those that listen, by id - 1.
  std::vector<Eigen::Index> Listening() const;
  /// The ids of those that lead.
  std::vector<int> Leaders() const;
  /// What all that listen are alike; nothing if they differ, or if nobody listens.
  std::optional<LinearAgent> Common() const;
  /// `graph` without what leaders could hear, but do not listen to.
  Graph Followed(const Graph& graph) const;
};

/// The experiment as a linear team, or why it is none.
struct Linearity {
  std::optional<LinearTeam> team;
  std::string why_not;
};

Linearity LinearTeamOf(const Experiment& experiment);
/// An agent that flies to its target by itself, under a law of this form, which does not listen.
LinearAgent FlyingAgent(const AgentConfig& agent, const LinearForm& form);

}  // namespace mascot
