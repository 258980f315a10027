#pragma once

#include <functional>
#include <memory>

#include "bus/outside_domain.h"
#include "experiment/vehicles.h"
#include "vehicle/autopilot.h"

namespace mascot {

/// A copter with ArduPilot 4.5 or newer and its interface on DDS. It takes velocities alone, in mode GUIDED: where a
/// position is wanted, this object steers there. `on_news` is called in threads of Fast DDS.
std::unique_ptr<Autopilot> MakeArdupilot(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                         std::function<void()> on_news);

}  // namespace mascot
