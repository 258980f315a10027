#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws/law_figures.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/low_level_loops.h"
#include "orchestrator/theory/response.h"

namespace mascot {

/// How a flight comes to agree, as AgreementMeter measures it.
struct LoopAgreement {
  std::optional<double> settling_time_s = {}, rate_per_s = {};
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();  ///< at the end
  double first_m = 0, last_m = 0;                    ///< disagreement at the start and at the end
  Response response = {};
};

/// What is measured of a flight on LowLevelLoops, or why this flight does not describe the experiment's.
struct LoopFlight {
  std::string silent = {};  ///< empty: it describes it
  std::vector<FigureValues> figures =
      {};  ///< of the team's law, in the order of LawEntry::figures; empty if it is silent
  LoopAgreement agreement = {};
  bool is_tilt_cut = false;  ///< at some time the limit of the tilt has cut a command
};

/// Flies the agents' own laws, graph, links and limits on LowLevelLoops, to the end of the experiment. All agents must
/// fly the team's law.
LoopFlight FlyLoops(const Experiment& experiment, const LoopError& error);

/// The work of such a flight: ticks times agents and edges.
double WorkOfLoops(const Experiment& experiment);

}  // namespace mascot
