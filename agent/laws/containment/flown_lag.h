#pragma once

#include <Eigen/Core>
#include <optional>

#include "agent/laws/law_figures.h"
#include "agent/laws/parts/leaders.h"

namespace mascot {

/// How followers come to their places among leaders at constant velocities, flown from the experiment's start.
struct FlownLag {
  double lag_m = 0;  ///< LargestLag() at the end of the run
  /// From when on the follower that is farthest from its final place stays within 2 %; absent: far too late.
  std::optional<HoldsFrom> settled{};
};
/// Followers want v_i = gain sum_j a_ij (p_j - p_i). `shares` has their places among the leaders, and `lag` how far
/// behind these they end (m), one row for each follower. The flight goes on beyond the end of the run until the
/// followers have settled. Nothing if the run alone is more work than kMaxFlownFollowers.
std::optional<FlownLag> FlyToPlaces(const Experiment& experiment, const LedTeam& team, double gain,
                                    const Eigen::MatrixXd& shares, const Eigen::MatrixX3d& lag);

inline constexpr double kMaxFlownFollowers = 2e7;  ///< agents and edges times ticks

}  // namespace mascot
