#pragma once

#include <span>
#include <string>

#include "base/contacts.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/measuring/run_meter.h"

namespace mascot {

/// What the agent of a contact touched: "agent 4", "ground", "obstacle 2".
std::string PartnerOf(const Contact& contact);
/// All incidents of a run. `by_hand`: the numbers of the events that were given by hand, increasing.
Incidents IncidentsOf(const RunMeter& meter, const EngineResult& engine, std::span<const int> by_hand);
/// Text of events.csv; docs/recording.md describes the columns.
std::string IncidentsCsv(const Experiment& experiment, const Incidents& incidents);
/// The first incident of each kind but events, in words, and how many more of this kind there were; empty if there was
/// none.
std::string IncidentsText(const Experiment& experiment, const Incidents& incidents);

}  // namespace mascot
