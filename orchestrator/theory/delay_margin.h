#pragma once

#include <optional>

#include "experiment/graph/graph.h"
#include "orchestrator/theory/linear_team.h"

namespace mascot {

/// Largest delay of neighbours' samples, equal for all of them, with which a team settles. Own states are known without
/// delay; continuous time.
struct DelayMargin {
  bool independent = false;        ///< the team settles with any delay
  std::optional<double> margin_s;  ///< the team does not settle from this delay on (s)
};

/// The delay margin of a team that settles without delay, on a constant graph; delay_margin.cc has the derivation.
/// Nothing if a sweep over frequencies is needed and a strongly connected component has too many agents for it: more
/// than kLargestSweep, or kLargestRegular if its agents are alike and have equal sums of weights.
std::optional<DelayMargin> LinkDelayMargin(const LinearTeam& team, const Graph& graph);

inline constexpr int kLargestSweep = 24;
inline constexpr int kLargestRegular = 300;

}  // namespace mascot
