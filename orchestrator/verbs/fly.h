#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/crew.h"
#include "experiment/experiment.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/dds/engine.h"
#include "orchestrator/engines/dds/machine/janitor.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/recording/run_folder.h"
#include "system/console.h"
#include "system/stop_signal.h"

namespace CLI {
class App;
}

namespace mascot {

class ActionSource;
class RosSource;
class RowSink;

/// --engine and --threads.
struct EngineArgs {
  std::string name;
  std::optional<int> threads;

  /// Declares both; `help` is that of --engine. `*this` must outlive the parsing.
  void AddTo(CLI::App& command, const std::string& help);
  /// Throws ConfigError if this engine cannot fly the experiment, or not so. `gives_actions`: there is an ActionSource.
  void Refuse(const Experiment& experiment, bool gives_actions = false) const;
  /// The threads that are to fly the run, with the one that calls: exactly as many as were asked for, or at most as
  /// many as there are cores but for `others` threads that work beside them; no more than a team of this size keeps
  /// busy. Over DDS, only the one that calls. Throws what Crew throws.
  Crew MakeCrew(const Experiment& experiment, int others) const;
};

/// One experiment on one engine.
class EngineRun {
 public:
  /// Every sink gets every row, in tick order. `requests`: what people ask of the run, also one of the sinks; null:
  /// they cannot ask anything. `crew`: computes a run in this process. `ros`, if given, is published for RViz2.
  /// `actions`: what agents do whose laws take actions; null: there are no such agents. All arguments must outlive this
  /// object.
  EngineRun(const std::string& engine, const Experiment& experiment, const RunFolder& folder,
            const std::vector<RowSink*>& sinks, RunRequests* requests, Console& console, StopSignal& stop, Crew& crew,
            RosSource* ros = nullptr, ActionSource* actions = nullptr);

  /// Sets the contents that the file `path` gets if this process is killed during a run over DDS, or during one with
  /// laws of users in this process. Call it before Fly().
  void LeaveIfKilled(const std::string& path, const std::string& text);
  /// Flies. The first signal ends the run after its tick. A failure is reported in the result. The result is final:
  /// write it to files before calling End().
  EngineResult Fly();
  /// Ends what the run has started (DdsEngine::End()).
  void End(bool process_goes_on);
  /// After End(): if the DDS library has not let go (DdsEngine::End()), ends this process by force with this exit code.
  void LeaveByForceIfNeeded(int code) const;

 private:
  const Experiment& experiment_;
  const std::vector<RowSink*>& sinks_;
  RunRequests* const requests_;
  Console& console_;
  StopSignal& stop_;
  Crew& crew_;
  ActionSource* const actions_;
  std::optional<DdsEngine> dds_;    // absent: in this process
  std::optional<Janitor> janitor_;  // in this process, with laws of users
  bool has_left_ = true;
};

}  // namespace mascot
