#pragma once

#include "bus/wire.h"
#include "experiment/experiment.h"
#include "orchestrator/live/shown/ui_channels.h"
#include "orchestrator/ros/ros_scene.h"

namespace mascot {

/// A row that viewers see, for scenes and transforms of ROS 2. Valid as long as the row.
inline SceneMoment MomentOf(const Experiment& experiment, const ShownRow& row) {
  return {.time_ns = StampNs(row.tick, experiment.control.rate_hz), .motions = row.decoded.motions, .edges = row.edges};
}

}  // namespace mascot
