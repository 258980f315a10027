#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/live/shown/ui_channels.h"

namespace mascot {

/// The first lines of the events.csv beside the recording at this path, as many as a page can mark; empty: there is
/// none.
std::string FirstIncidentsBeside(const std::string& recording);
/// Notes in `events` which of them that events.csv says were given by hand, and which were not. An event that it does
/// not have, or has at another time or with another text, stays as it is: nobody knows.
void TellByHand(const std::string& recording, const Experiment& experiment, std::vector<ShownEvent>& events);

}  // namespace mascot
