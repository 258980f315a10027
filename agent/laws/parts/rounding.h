#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "experiment/experiment.h"

namespace mascot {

/// How far off rounding may put a figure of a run by the tick `ticks`, as a share of the magnitude of the numbers from
/// which the figure is computed. This is the one place that says so, for everything that theory predicts exactly or
/// bounds.
///
/// Each number that a tick changes is rounded a few times: in the law, in the command, and at each step of the physics.
/// A rounding is off by half a unit in the last place, epsilon / 2 of the number. In a stable team these errors do not
/// grow, so that together they are at most their sum. This is far above what runs show, because errors of different
/// signs cancel.
inline double RoundingShare(const Experiment& experiment, std::int64_t ticks) {
  constexpr double kRoundings = 16;  // of a tick, in the law, the command and the figure
  const double of_a_tick = kRoundings + 2 * experiment.steps_per_tick();
  return std::numeric_limits<double>::epsilon() / 2 * of_a_tick * static_cast<double>(ticks + 1);
}
/// The same share for a figure at the end of the run, or of the whole run.
inline double RoundingShare(const Experiment& experiment) { return RoundingShare(experiment, experiment.ticks()); }

/// The largest component of the agents' positions at the start (m): the magnitude of the positions of a team that stays
/// where it starts.
inline double LargestStart_m(const Experiment& experiment) {
  double largest_m = 0;
  for (const AgentConfig& agent : experiment.agents) largest_m = std::max(largest_m, agent.p_W.cwiseAbs().maxCoeff());
  return largest_m;
}

/// The same magnitude for the root of the sum of squares over all agents (m).
inline double SizeOfStart_m(const Experiment& experiment) {
  return LargestStart_m(experiment) * std::sqrt(experiment.size());
}

}  // namespace mascot
