#pragma once

#include <memory>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/dds/stepper.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/ros_source.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/team/action_source.h"
#include "orchestrator/team/row_sink.h"
#include "system/console.h"
#include "system/stop_signal.h"

namespace mascot {

class DdsRun;

/// Runs an experiment as separate processes in a DDS domain of its own: a physics server and the agent processes. It
/// waits for external agents, and does not start them. The calling process records: `sinks` get every row, in tick
/// order. People steer the run by `requests`; null: they cannot. `ros`, if given, is published for RViz2. `actions`:
/// what agents do whose laws take actions; null: they are given 0. `stepper`: who steps the run from outside, and gives
/// these actions himself; null: nobody does.
class DdsEngine {
 public:
  DdsEngine(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks,
            RunRequests* requests, Console& console, StopSignal& stop, RosSource* ros = nullptr,
            ActionSource* actions = nullptr, Stepper* stepper = nullptr);
  ~DdsEngine();  ///< calls End()
  DdsEngine(const DdsEngine&) = delete;
  DdsEngine& operator=(const DdsEngine&) = delete;

  /// Sets the contents that this file gets if this process is killed while it flies (Janitor::LeaveWords()). Call it
  /// before Fly().
  void LeaveIfKilled(const std::string& path, const std::string& text);
  /// Flies until the run is over, for whatever reason. The result reports a failure. It is final; the caller should
  /// write it to files before it calls End().
  EngineResult Fly();
  /// Ends every child process, leaves the domain and removes the run's shared memory. Returns false if this process has
  /// to end by _exit(), because threads of the DDS library go on: the library has not let go within 5 s and before a
  /// signal, which a line on the console says, or it was not asked to, because `process_goes_on` is false and a child
  /// of a run that shares memory has been killed. The run's Janitor removes the shared memory then.
  bool End(bool process_goes_on);

 private:
  std::unique_ptr<DdsRun> run_;
};

}  // namespace mascot
