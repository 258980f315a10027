#pragma once

#include <string>
#include <vector>

#include "agent/law_figures.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/low_level_loop.h"

namespace mascot {

/// What the law of a team measures of a flight on LowLevelLoops, or why this is not the flight of the experiment.
struct LoopFlight {
  std::string silent;                 ///< empty: it is
  std::vector<FigureValues> figures;  ///< in the order of LawEntry::figures; empty if it is silent
};

/// Flies the agents' own laws, graph, links and limits on LowLevelLoops, to the end of the experiment. All agents must
/// fly the team's law, which must have a meter.
LoopFlight FlyLoops(const Experiment& experiment, const LoopError& error);

/// How much work that is: ticks times agents and edges.
double WorkOfLoops(const Experiment& experiment);

}  // namespace mascot
