#pragma once

#include <optional>

#include "experiment/graph/graph.h"
#include "orchestrator/theory/linear_team.h"

namespace mascot {

/// How late what agents hear may be, all of it alike, while they know themselves at once; in continuous time.
struct DelayMargin {
  bool independent = false;        ///< no delay can do harm
  std::optional<double> margin_s;  ///< from this delay on the team does not settle
};

/// Of a team that settles without delay, on a graph that does not change. Nothing where only a sweep could tell, and
/// too many agents hear each other for that: more than kLargestSweep, or kLargestRegular if they are all alike and hear
/// as many.
std::optional<DelayMargin> LinkDelayMargin(const LinearTeam& team, const Graph& graph);

inline constexpr int kLargestSweep = 24;
inline constexpr int kLargestRegular = 300;

}  // namespace mascot
