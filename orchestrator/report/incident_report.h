#pragma once

#include <string>

#include "experiment/contacts.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/measuring/run_meter.h"

namespace mascot {

/// What the agent touched: "agent 4", "ground", "obstacle 2".
std::string PartnerOf(const Contact& contact);
/// All incidents of a run.
Incidents IncidentsOf(const RunMeter& meter, const EngineResult& engine);
/// Text of events.csv; docs/recording.md describes the columns.
std::string IncidentsCsv(const Experiment& experiment, const Incidents& incidents);
/// The first incident of each kind in words, and how many there were; empty if there was none.
std::string IncidentsText(const Experiment& experiment, const Incidents& incidents);

}  // namespace mascot
