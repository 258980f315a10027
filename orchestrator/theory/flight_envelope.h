#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

/// The largest acceleration along x or y for which a quadrotor leans no further than its airframe may (m/s^2), while it
/// holds its height.
double LeanLimit(const AgentConfig& quadrotor, double gravity_m_per_s2);

/// Warnings, as "key: text", about quadrotors whose rotors cannot lift them.
std::vector<std::string> LiftWarnings(const Experiment& experiment);

}  // namespace mascot
