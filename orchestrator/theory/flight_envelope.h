#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The largest acceleration along x or y (m/s^2) that a quadrotor reaches at constant height within the tilt limit of
/// its airframe.
double LeanLimit(const AgentConfig& quadrotor, double gravity_m_per_s2);

/// Warnings ("key: text") about quadrotors whose rotors cannot lift their weight.
std::vector<std::string> LiftWarnings(const Experiment& experiment);

}  // namespace mascot
