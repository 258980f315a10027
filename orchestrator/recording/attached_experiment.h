#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiment/experiment.h"

namespace mascot {

// The experiment that is attached to a recording, as TOML text (Experiment::resolved), and what is left out of it so
// that equal runs have equal recordings.

/// The resolved experiment as attached: with the default domain, processes, delivery and pace, without hosts, security
/// and a view for RViz2. Runs that differ only in these have the same recording.
std::string WithoutDelivery(const Experiment& experiment);
/// The same without events.
std::string WithoutEvents(const Experiment& experiment);
/// The values that this experiment has of keys that WithoutDelivery() gives their defaults: domain, processes and
/// delivery.
std::vector<Override> DeliveryOverrides(const Experiment& experiment);
/// The resolved experiment with other values of these keys. Throws ConfigError if that is no valid experiment.
std::string WithOverrides(const Experiment& experiment, const std::vector<Override>& changes);
/// The experiment with these events, given by hand, behind its own. Throws as WithOverrides() does.
Experiment WithEvents(const Experiment& experiment, const std::vector<Event>& by_hand);

/// The resolved experiment of a run that was stopped after so many ticks, at least 1: it repeats what was flown, and
/// flies one tick more if agents have not answered the last one, because events of the next tick say so. Events that
/// were still to come are left out. Throws as WithOverrides() does.
std::string StoppedAfter(const Experiment& experiment, std::int64_t ticks);

}  // namespace mascot
