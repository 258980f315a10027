#include "orchestrator/verbs/fly.h"

#include "agent/laws.h"
#include "bus/leave.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/processes/interruptions.h"

namespace mascot {

void RefuseEngine(const std::string& engine, const Experiment& experiment) {
  if (engine == kOverDds) return RefuseTooManyProcesses(experiment);
  if (experiment.run.mode == Mode::kRealtime)  // in one process there is no pacing
    throw ConfigError({"--engine inprocess: expected run.mode = \"lockstep\", got \"realtime\""});
  if (experiment.network.ros_view)  // there is no DDS
    throw ConfigError({"--engine inprocess: expected network.ros_view = false, got true"});
}

Flight::Flight(const std::string& engine, const Experiment& experiment, const RunFolder& folder,
               const std::vector<RowSink*>& sinks, Console& console, StopSignal& stop, RosSource* ros)
    : experiment_(experiment), sinks_(sinks), console_(console), stop_(stop) {
  if (engine == kOverDds) dds_.emplace(experiment, folder, sinks, console, stop, ros);
}

EngineResult Flight::Fly() {
  if (dds_) return dds_->Fly();
  const Interruptions interruptions(stop_, console_);
  EngineResult result = RunInProcess(experiment_, sinks_, [&] { return interruptions.signal() == 0; });
  result.signal = interruptions.signal();
  return result;
}

void Flight::End() {
  if (dds_) hangs_ = !dds_->End();
}

void Flight::LeaveIfItHangs(int code) const {
  if (hangs_) LeaveNow({.code = code, .process = "orchestrator"});  // its threads use what would be destroyed
}

std::string WithoutDelivery(const Experiment& experiment) {
  const auto& network = experiment.network;
  if (network.domain < 0 && network.agents_per_process == 1 && network.delivery == Delivery::kTopics &&
      !network.ros_view)
    return experiment.resolved;
  const Override usual[] = {{"network.domain", "\"auto\""},
                            {"network.agents_per_process", "1"},
                            {"network.delivery", "\"topics\""},
                            {"network.ros_view", "false"}};
  return LoadExperiment(Section::FromText(experiment.resolved, "config.toml", usual), experiment.run.name,
                        /*checked=*/true)
      .resolved;
}

}  // namespace mascot
