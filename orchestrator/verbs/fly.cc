#include "orchestrator/verbs/fly.h"

#include "agent/laws.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/dds/engine.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/processes/interruptions.h"

namespace mascot {

void RefuseEngine(const std::string& engine, const Experiment& experiment) {
  if (engine == kOverDds) return RefuseTooManyProcesses(experiment);
  if (experiment.run.mode == Mode::kRealtime)  // in one process there is no pacing
    throw ConfigError({"--engine inprocess: expected run.mode = \"lockstep\", got \"realtime\""});
}

EngineResult Fly(const std::string& engine, const Experiment& experiment, const RunFolder& folder,
                 const std::vector<RowSink*>& sinks, Console& console, StopSignal& stop) {
  if (engine == kOverDds) return RunOverDds(experiment, folder, sinks, console, stop);
  const Interruptions interruptions(stop, console);
  EngineResult result = RunInProcess(experiment, sinks, [&] { return interruptions.signal() == 0; });
  result.signal = interruptions.signal();
  return result;
}

std::string WithoutDelivery(const Experiment& experiment) {
  const auto& network = experiment.network;
  if (network.domain < 0 && network.agents_per_process == 1 && network.delivery == Delivery::kTopics)
    return experiment.resolved;
  const Override usual[] = {
      {"network.domain", "\"auto\""}, {"network.agents_per_process", "1"}, {"network.delivery", "\"topics\""}};
  return LoadExperiment(Section::FromText(experiment.resolved, "config.toml", usual), experiment.run.name,
                        /*checked=*/true)
      .resolved;
}

}  // namespace mascot
