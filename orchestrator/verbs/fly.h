#pragma once

#include <string>
#include <vector>

#include "bus/stop_signal.h"
#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/processes/console.h"
#include "orchestrator/recording/run_folder.h"

namespace mascot {

class RowSink;

/// Values of --engine.
inline constexpr const char* kOverDds = "dds";
inline constexpr const char* kInProcess = "inprocess";

/// Throws ConfigError if this engine cannot fly the experiment.
void RefuseEngine(const std::string& engine, const Experiment& experiment);
/// Flies the experiment on this engine. Every sink gets every row, in tick order. The first signal ends the run after
/// its tick. A failure is reported in the result.
EngineResult Fly(const std::string& engine, const Experiment& experiment, const RunFolder& folder,
                 const std::vector<RowSink*>& sinks, Console& console, StopSignal& stop);

/// The resolved experiment as attached to the recording: with the default domain, processes and delivery, so that runs
/// that differ only in these have the same recording.
std::string WithoutDelivery(const Experiment& experiment);

}  // namespace mascot
