#include "orchestrator/engines/dds/fleet_links.h"

#include <algorithm>
#include <utility>

namespace mascot {

FleetLinks::FleetLinks(Domain& domain, const Experiment& experiment, Fleet& fleet, std::function<void()> wake)
    : fleet_(fleet) {
  for (const int agent : AgentsWithVehicles(experiment))
    readers_.push_back(std::make_unique<Reader<VehicleStatusType>>(
        domain, Topic::Vehicle(agent), [this, wake](const mascot_msgs::msg::VehicleStatus& status) {
          {
            const std::lock_guard lock(mutex_);
            heard_.push_back(status);
          }
          wake();
        }));
}

bool FleetLinks::Matched() const {
  return std::ranges::all_of(readers_, [](const auto& reader) { return reader->matched() >= 1; });
}

void FleetLinks::Pass() {
  std::vector<mascot_msgs::msg::VehicleStatus> heard;
  {
    const std::lock_guard lock(mutex_);
    heard = std::exchange(heard_, {});
  }
  for (const auto& status : heard) fleet_.Take(status);
}

}  // namespace mascot
