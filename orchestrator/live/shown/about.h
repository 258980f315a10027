#pragma once

#include <cstdint>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/live/server/foxglove.h"

namespace mascot {

/// Channels of the page, in this order, and the first of those that follow.
enum UiChannel : Foxglove::ChannelId { kExperimentChannel, kFrameChannel, kEventsChannel, kFirstOfRos };

/// What clients are told of a run when they come: the channels of the page, then `ros`; the service; who hears whom;
/// that it ends at `last_tick`. `experiment` must outlive the result.
Foxglove::About AboutTheRun(const Experiment& experiment, std::vector<Foxglove::Channel> ros, std::int64_t last_tick);

}  // namespace mascot
