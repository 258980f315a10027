#pragma once

// What theory.cc and the files for each kind of law share; nobody else includes this.

#include <Eigen/Core>
#include <optional>

#include "experiment/experiment.h"
#include "orchestrator/theory.h"

namespace mascot {

/// Axes that the law moves: x and y, or z too.
inline int AxisCount(const Experiment& experiment) { return experiment.law.axes == Axes::kXyz ? 3 : 2; }
/// With law.axes = "xy" every agent keeps its own height, and the mean of them is what a meeting point has.
Eigen::Vector3d AtHeldHeight(const Experiment& experiment, Eigen::Vector3d value_m);
/// Where everyone gathers at the leader, if it rests; `flies`: it has waypoints.
std::optional<Eigen::Vector3d> RestingLeader(const Experiment& experiment, bool flies);

void PredictConsensus(Experiment& experiment, Prediction& prediction);  // theory_linear.cc
void PredictWaypoint(Experiment& experiment, Prediction& prediction);   // theory_linear.cc
void PredictMinmax(Experiment& experiment, Prediction& prediction);     // theory_minmax.cc

}  // namespace mascot
