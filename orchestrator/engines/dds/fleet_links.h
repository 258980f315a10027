#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "bus/bus.h"
#include "orchestrator/engines/dds/fleet.h"

namespace mascot {

/// Hears the processes of the vehicles of a run.
class FleetLinks {
 public:
  /// `wake` is called, in a thread of Fast DDS, when one has said something. Both `domain` and `fleet` must outlive
  /// this object.
  FleetLinks(Domain& domain, const Experiment& experiment, Fleet& fleet, std::function<void()> wake);

  bool Matched() const;
  /// Passes on to the fleet what has been heard since the last call. Throws what Fleet::Take() throws.
  void Pass();

 private:
  Fleet& fleet_;
  std::mutex mutex_;  // guards heard_
  std::vector<mascot_msgs::msg::VehicleStatus> heard_;
  std::vector<std::unique_ptr<Reader<VehicleStatusType>>> readers_;  // last: their callbacks use the members above
};

}  // namespace mascot
