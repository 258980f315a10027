#pragma once

#include <string>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// What only the orchestrator knows of a run.
struct RunFacts {
  std::string engine;  ///< "dds" | "inprocess"
  int exit = 0;
  std::size_t topics = 0;     ///< recorded
  std::uint64_t samples = 0;  ///< recorded
  double total_s = 0;         ///< from `up` to the last file but summary.json
};

/// summary.json: keys and definitions in docs/recording.md.
std::string SummaryJson(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts);
/// The same for people: predicted beside measured, in a few lines.
std::string SummaryText(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                        const EngineResult& engine, const RunFacts& facts);

}  // namespace mascot
