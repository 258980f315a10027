#pragma once

#include <optional>

#include "experiment/graph/graph.h"
#include "orchestrator/theory/linear_team.h"

namespace mascot {

/// Delay of neighbours' samples, equal for all of them, with which a sampled team settles. Own states are known without
/// delay.
struct DelayMargin {
  bool independent = false;        ///< the team settles with any delay
  std::optional<double> margin_s;  ///< the shortest delay of whole control periods with which it does not settle (s)
};

/// The delay margin of a team that settles without delay, on a constant graph, with control period `period_s`;
/// delay_margin.cc has the derivation. Nothing if a strongly connected component of the graph
///   has agents that differ in order or hold, or gains that a period so long leaves close to unstable, or
///   needs a sweep over frequencies and has too many agents for it: more than kLargestSweep, or kLargestRegular if its
///   agents are alike and have equal sums of weights.
std::optional<DelayMargin> LinkDelayMargin(const LinearTeam& team, const Graph& graph, double period_s);

inline constexpr int kLargestSweep = 24;
inline constexpr int kLargestRegular = 300;

}  // namespace mascot
