#pragma once

#include <Eigen/Core>
#include <optional>

#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// How a linear team comes to agree from where and as fast as the experiment's agents start: as AgreementMeter measures
/// it by the end of the run, or, where that ends too early for it, later.
struct FromStart {
  bool is_flown = false;                        ///< false: that is too much work
  std::optional<double> settling_time_s = {};   ///< nothing: it does not settle in time
  std::optional<double> rate_per_s = {};        ///< likewise, or there are too few rows to measure it
  bool agrees = false;                          ///< agents agree already when they start: there is nothing to settle
  bool is_cut = false;                          ///< a limit of acceleration or speed has cut what the laws ask for
  std::optional<Eigen::Vector3d> value_m = {};  ///< where agents meet, along their axes; nothing: not in time
};

/// Steps the sampled team (sampled_team.h) tick by tick, with the limits of what agents may ask for, on average where
/// links lose samples, until it agrees for good, but for at most `longest_s` of simulated time. Nothing if that is more
/// work than kMostSteps. Leaders must stand still.
FromStart FlyFromStart(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline,
                       double longest_s);

inline constexpr double kMostSteps = 2e7;  ///< ticks times agents and edges; takes about 0.3 s

}  // namespace mascot
