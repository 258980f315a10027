#include "orchestrator/verbs/fly.h"

#include "agent/laws/laws.h"
#include "agent/user_code/last_words.h"
#include "bus/leave.h"
#include "orchestrator/engines/dds/delivery.h"
#include "orchestrator/engines/inprocess.h"
#include "system/interruptions.h"

namespace mascot {
void RefuseEngine(const std::string& engine, const Experiment& experiment) {
  if (engine == kOverDds) return RefuseTooManyProcesses(experiment);
  if (experiment.run.mode == Mode::kRealtime)  // in one process there is no pacing
    throw ConfigError({"--engine inprocess: expected run.mode = \"lockstep\", got \"realtime\""});
  if (experiment.network.ros_view)  // there is no DDS
    throw ConfigError({"--engine inprocess: expected network.ros_view = false, got true"});
}

Flight::Flight(const std::string& engine, const Experiment& experiment, const RunFolder& folder,
               const std::vector<RowSink*>& sinks, RunRequests* requests, Console& console, StopSignal& stop,
               RosSource* ros)
    : experiment_(experiment), sinks_(sinks), requests_(requests), console_(console), stop_(stop) {
  if (engine == kOverDds)
    dds_.emplace(experiment, folder, sinks, requests, console, stop, ros);
  else if (FliesCodeOfUsers(experiment))
    janitor_.emplace();
}

void Flight::LeaveIfKilled(const std::string& path, const std::string& text) {
  if (dds_) dds_->LeaveIfKilled(path, text);
  if (janitor_) janitor_->LeaveWords(path, text);
}

EngineResult Flight::Fly() {
  if (dds_) return dds_->Fly();
  const Interruptions interruptions(stop_, console_, [](int code) {
    const char* const reason = "a second signal has ended the process at once";
    LastWords::Leave(&reason, 1, code);
  });
  EngineResult result = RunInProcess(
      experiment_, sinks_, [&] { return interruptions.signal() == 0; }, requests_);
  result.signal = interruptions.signal();
  return result;
}

void Flight::End() {
  if (janitor_) janitor_->Dismiss();  // the orchestrator kills what laws have started at its own end
  if (dds_) hangs_ = !dds_->End();
}

void Flight::LeaveIfItHangs(int code) const {
  if (hangs_) LeaveNow({.code = code, .process = "orchestrator"});  // its threads use what would be destroyed
}

}  // namespace mascot
