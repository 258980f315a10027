#include "vehicle/kinds.h"

#include <stdexcept>
#include <utility>

#include "vehicle/ardupilot/ardupilot.h"
#include "vehicle/crazyswarm/crazyswarm.h"
#include "vehicle/px4/px4.h"

namespace mascot {

std::unique_ptr<Autopilot> MakeAutopilot(const OutsideDomain::Options& options, const VehicleConfig& vehicle,
                                         std::function<void()> on_news) {
  switch (vehicle.kind) {
    case VehicleKind::kPx4:
      return MakePx4(options, vehicle, std::move(on_news));
    case VehicleKind::kCrazyswarm:
      return MakeCrazyswarm(options, vehicle, std::move(on_news));
    case VehicleKind::kArdupilot:
      return MakeArdupilot(options, vehicle, std::move(on_news));
  }
  throw std::logic_error("a vehicle of a kind that nobody has made");
}

}  // namespace mascot
