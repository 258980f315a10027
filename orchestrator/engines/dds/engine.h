#pragma once

#include <memory>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/control/helm.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/ros_source.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/team/row_sink.h"
#include "system/console.h"
#include "system/stop_signal.h"

namespace mascot {

class DdsRun;

/// Runs an experiment as separate processes in a DDS domain of its own: a physics server and the agent processes.
/// External agents are waited for, not started. The calling process records: `sinks` get every row, in tick order.
/// `helm`: where people steer the run; null: nowhere. `ros`, if given, is published for RViz2.
class DdsEngine {
 public:
  DdsEngine(const Experiment& experiment, const RunFolder& folder, const std::vector<RowSink*>& sinks, Helm* helm,
            Console& console, StopSignal& stop, RosSource* ros = nullptr);
  ~DdsEngine();  ///< calls End()
  DdsEngine(const DdsEngine&) = delete;
  DdsEngine& operator=(const DdsEngine&) = delete;

  /// What this file gets if this process is killed while it flies (Janitor::LeaveWords()). To be called before Fly().
  void LeaveIfKilled(const std::string& path, const std::string& text);
  /// Flies until the run is over, for whatever reason. A failure is reported in the result. The result is final; the
  /// caller should write it to files before it calls End().
  EngineResult Fly();
  /// Ends every child process, leaves the domain and removes the run's shared memory. Returns whether the DDS library
  /// let go within 5 s and before a signal. If not, its threads go on, and this process has to end by _exit(); the
  /// run's Janitor then removes the shared memory.
  bool End();

 private:
  std::unique_ptr<DdsRun> run_;
};

}  // namespace mascot
