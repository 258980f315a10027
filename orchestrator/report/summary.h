#pragma once

#include <optional>
#include <string>

#include "experiment/experiment.h"
#include "orchestrator/measuring/incident_meter.h"
#include "orchestrator/report/run_figures.h"

namespace mascot {

/// Text of summary.json of a run of which nothing is known but why it ended: its first keys, and no figure.
std::string SummaryOfTheUnknown(const Experiment& experiment, const std::string& engine, std::optional<int> exit,
                                const std::string& failure);
/// Text of summary.json; docs/recording.md describes the keys. `exit`: exit code of `up`; absent while it is not known
/// yet. `total_s`: wall-clock time from the start of `up` until this is written.
std::string SummaryJson(const RunFigures& figures, std::optional<int> exit, double total_s);
/// The same in a few lines of text, with predictions beside measurements. `incidents`: IncidentsOf() the run.
std::string SummaryText(const RunFigures& figures, const Incidents& incidents);

}  // namespace mascot
