#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The largest acceleration along x or y (m/s^2) that a quadrotor reaches within the tilt limit of its airframe, with
/// the thrust that carries its weight (at least Airframe::MinCommandedThrust()).
double LeanLimit(const AgentConfig& quadrotor, double gravity_m_per_s2);

/// The mean lag (s) of a quadrotor's acceleration along x or y behind a wanted one that jumps from -a to a. Assumes
/// that nothing but this turn occupies the rotors. docs/theory.md has the formula.
double AccelerationLag(const Experiment& experiment, const AgentConfig& quadrotor, double a_m_per_s2);

/// Warnings ("key: text") about quadrotors that cannot keep their height: their weight is outside the thrust that the
/// low-level stack uses.
std::vector<std::string> LiftWarnings(const Experiment& experiment);

/// A warning ("key: text") about the first rotor failure that leaves too little: without roll, pitch and yaw, each of
/// the four rotors carries a quarter of the weight, because those at opposite ends and those that turn the same way
/// must balance.
std::vector<std::string> RotorFailureWarnings(const Experiment& experiment);

}  // namespace mascot
