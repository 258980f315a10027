#pragma once

#include <cstdint>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/live/server/foxglove.h"

namespace mascot {

/// Channels of the page, in this order, and the first of those that follow.
enum UiChannel : Foxglove::ChannelId {
  kExperimentChannel,
  kFrameChannel,
  kEventsChannel,
  kCurvesChannel,
  kMetricsChannel,
  kVehiclesChannel,
  kFirstOfRos
};

/// What a client learns of a run when it connects: the channels of the page, then `ros`; the service; which agent hears
/// which; that the run ends at `last_tick`. `experiment` must outlive the result.
Foxglove::About AboutTheRun(const Experiment& experiment, std::vector<Foxglove::Channel> ros, std::int64_t last_tick);

}  // namespace mascot
