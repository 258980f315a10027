#pragma once

#include <functional>
#include <memory>

#include "bus/outside_domain.h"
#include "experiment/vehicles.h"
#include "vehicle/autopilot.h"

namespace mascot {

/// A PX4 autopilot by its topics, through the bridge on its side; see MakeAutopilot(). Source:
/// VehicleOdometry, VehicleStatus, OffboardControlMode, TrajectorySetpoint and VehicleCommand of PX4 1.14 to 1.18.
std::unique_ptr<Autopilot> MakePx4(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                   std::function<void()> on_news);

}  // namespace mascot
