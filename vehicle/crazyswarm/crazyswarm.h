#pragma once

#include <functional>
#include <memory>

#include "bus/outside_domain.h"
#include "experiment/vehicles.h"
#include "vehicle/autopilot.h"

namespace mascot {

/// A Crazyflie by the topics of its Crazyswarm2 server; see MakeAutopilot(). The server says where it is, not how fast:
/// velocities are differences of places, smoothed. It lands by set-points that sink: high-level commands of the server
/// would not take over from these before they have stopped. Source: Crazyswarm2, as of July 2026.
std::unique_ptr<Autopilot> MakeCrazyswarm(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                          std::function<void()> on_news);

}  // namespace mascot
