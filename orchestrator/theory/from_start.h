#pragma once

#include <Eigen/Core>
#include <optional>

#include "orchestrator/theory/linear_team.h"
#include "orchestrator/theory/response.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// How a linear team comes to agree, from the positions and velocities with which the experiment's agents start. Times
/// and rates are what AgreementMeter measures by the end of the run or, if the run ends too early for a value, by the
/// end of this flight.
struct FromStart {
  bool is_flown = false;                       ///< false: the flight is too much work, and all else is unset
  std::optional<double> settling_time_s = {};  ///< from the start (s); nothing: the team does not settle in this flight
  std::optional<double> rate_per_s = {};       ///< decay rate (1/s); nothing: it is too slow, or the rows are too few
  bool agrees = false;                         ///< the agents agree when they start: there is nothing to settle
  bool is_cut = false;                         ///< a limit of acceleration or speed has cut what the laws want
  std::optional<Eigen::Vector3d> value_m = {};  ///< mean of q = p - d at the end, in W (m); nothing: they have not met
  Response response = {};  ///< up to the end of the run, or until they agree; of those who agree at the start, empty
};

/// Steps the sampled team (sampled_team.h) tick by tick, with the limits of acceleration and speed, until it agrees for
/// good, but for at most `longest_s` of simulated time. If links lose samples, the flight is that of the mean over many
/// seeds. If ticks times agents and edges are more than kMaxSteps, nothing is flown. `team` and `timeline` must be
/// those of `experiment`; its leaders must stand still.
FromStart FlyFromStart(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline,
                       double longest_s);

inline constexpr double kMaxSteps = 2e7;  ///< as many take about 0.3 s

}  // namespace mascot
