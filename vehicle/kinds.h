#pragma once

#include <functional>
#include <memory>

#include "bus/outside_domain.h"
#include "experiment/vehicles.h"
#include "vehicle/autopilot.h"

namespace mascot {

/// The interface of a vehicle, as its kind says. `options`: of a participant in the vehicle's domain. `on_news` is
/// called, from any thread, when its Report() has changed.
std::unique_ptr<Autopilot> MakeAutopilot(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                         std::function<void()> on_news);

}  // namespace mascot
