#pragma once

#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/live/shown/ui_channels.h"

namespace mascot {

/// The first lines of the events.csv beside the recording at this path, as many as a page can mark; empty: there is
/// none.
std::string FirstIncidentsBeside(const std::string& recording);
/// Notes in `events`, whose numbers increase, which of them, according to that events.csv, were given by hand, and
/// which were not. If events.csv does not have an event, or has it at another time or with another text, that event
/// alone stays as it is: it is not known how it was given.
void MarkManualEvents(const std::string& recording, const Experiment& experiment, std::vector<ShownEvent>& events);

}  // namespace mascot
