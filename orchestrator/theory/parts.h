#pragma once

// Declarations shared by theory.cc and the files for each kind of law; internal to this folder.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "agent/laws/laws.h"
#include "experiment/experiment.h"
#include "orchestrator/theory/modes.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/theory/timeline.h"

namespace mascot {

/// The gain that makes unstable modes stable.
struct GainBound {
  std::string key;
  double least = 0;  ///< the gain must be larger than this
  double got = 0;    ///< its value in the experiment
};

/// Returns whether all modes decay, in continuous time and sampled; else adds a warning that names the gain or rate to
/// change. Sets the bound of the control period.
bool JudgeModes(const Experiment& experiment, std::span<const LinearMode> modes, const GainBound& gain,
                Prediction& prediction);
/// Sets the bound `longest_s` of the control period. Returns whether the control period is shorter; else adds a
/// warning.
bool JudgePeriod(const Experiment& experiment, double longest_s, Prediction& prediction);

// Each adds its predictions to `prediction`, in which `persistence` is already set.
void PredictLinear(const Experiment& experiment, const Timeline& timeline, Prediction& prediction);  // linear.cc
void PredictFlight(const Experiment& experiment, const LinearForm& form, Prediction& prediction);    // flight.cc
void PredictPursuit(const Experiment& experiment, const Timeline& timeline, const PursuitForm& law,
                    Prediction& prediction);  // pursuit.cc

}  // namespace mascot
