#pragma once

// What theory.cc and the files for each kind of law share; nobody else includes this.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "agent/laws.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/modes.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// What would make unstable modes stable.
struct GainBound {
  std::string key;
  double least = 0;  ///< it must be above
  double got = 0;
};

/// Whether all modes decay in continuous time, and sampled; says what would make it so, and notes the period's bound.
bool JudgeModes(const Experiment& experiment, std::span<const LinearMode> modes, const GainBound& gain,
                Prediction& prediction);
/// Notes the longest control period, and whether ours is shorter; warns if not.
bool JudgePeriod(const Experiment& experiment, double longest_s, Prediction& prediction);

// Each adds to what is known of persistence.
void PredictLinear(const Experiment& experiment, const Timeline& timeline, Prediction& prediction);  // linear.cc
void PredictFlight(const Experiment& experiment, const LinearForm& form, Prediction& prediction);    // flight.cc
void PredictPursuit(const Experiment& experiment, const Timeline& timeline, const PursuitForm& law,
                    Prediction& prediction);  // pursuit.cc

}  // namespace mascot
