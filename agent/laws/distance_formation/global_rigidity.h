#pragma once

#include <span>

#include "agent/laws/parts/rigidity.h"

namespace mascot {

/// Above this many agents a graph that is not complete counts as globally rigid.
inline constexpr int kMaxAgentsOfGlobalRigidity = 60;

/// Whether the lengths of a rigid graph fix the shape of generic points, but for mirroring: no other points have the
/// same lengths. A graph that is rigid but not globally rigid has an agent, or a part, that may be flipped or folded
/// over. A random stress of random points decides; Gortler, Healy & Thurston, "Characterizing generic global rigidity",
/// American J. Math. 132 (2010), theorem 1.14: the graph is globally rigid if and only if the matrix of the stress has
/// the rank N - d - 1.
bool IsGloballyRigid(std::span<const Bar> bars, int agents, Axes axes);

}  // namespace mascot
