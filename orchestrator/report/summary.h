#pragma once

#include <optional>
#include <string>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/measuring/incident_meter.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// Facts about a run that neither the meters nor the engine result contain.
struct RunFacts {
  std::string engine;           ///< "dds" | "inprocess"
  std::optional<int> exit = 0;  ///< exit code of `up`; absent while it is not known yet
  std::size_t topics = 0;       ///< topics recorded
  std::uint64_t samples = 0;    ///< samples recorded
  double total_s = 0;           ///< wall-clock time from the start of `up` until summary.json is written
};

/// Text of summary.json of a run of which nothing is known but why it ended: its first keys, and no figure.
std::string SummaryOfTheUnknown(const Experiment& experiment, const std::string& engine, std::optional<int> exit,
                                const std::string& failure);
/// Text of summary.json; docs/recording.md describes the keys.
std::string SummaryJson(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts);
/// The same in a few lines of text, with predictions beside measurements. `incidents`: IncidentsOf() the run.
std::string SummaryText(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts, const Incidents& incidents);

}  // namespace mascot
